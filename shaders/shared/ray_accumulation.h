// Layout of the sums of what rays from pixels find, for C and GLSL.
#ifndef VOXCAST_SHADERS_SHARED_RAY_ACCUMULATION_H
#define VOXCAST_SHADERS_SHARED_RAY_ACCUMULATION_H

// Pictures of what rays from pixels have found, 4 floats a pixel: sums of irradiance / pi / scale
// and ambient visibility; their means; sums of what lobes mirror, in cd/m^2 times the share that is
// reflected, and of those shares; their quotients. The latter two only where there is gloss.
#define PLANE_DIFFUSE           0
#define PLANE_DIFFUSE_MEAN      1
#define PLANE_SPECULAR          2
#define PLANE_SPECULAR_MEAN     3
#define PLANES_WITHOUT_SPECULAR 2
#define PLANES_WITH_SPECULAR    4

#endif
