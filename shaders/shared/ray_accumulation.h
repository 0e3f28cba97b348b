// Layout of the ray samples' accumulation, in C and GLSL.
#ifndef VOXCAST_SHADERS_SHARED_RAY_ACCUMULATION_H
#define VOXCAST_SHADERS_SHARED_RAY_ACCUMULATION_H

// Accumulation planes, 4 floats per pixel: sums of irradiance / pi / scale and ambient visibility;
// filtered means of these; sums of specular radiance in cd/m^2 times sample weight, and of the
// weights; their quotients, filtered. The latter two only with specular lobes.
#define PLANE_DIFFUSE           0
#define PLANE_DIFFUSE_MEAN      1
#define PLANE_SPECULAR          2
#define PLANE_SPECULAR_MEAN     3
#define PLANES_WITHOUT_SPECULAR 2
#define PLANES_WITH_SPECULAR    4

#endif
