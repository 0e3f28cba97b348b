// Layout of the sums of what rays from pixels find, for C and GLSL.
#ifndef VOXCAST_SHADERS_SHARED_RAY_ACCUMULATION_H
#define VOXCAST_SHADERS_SHARED_RAY_ACCUMULATION_H

// Pictures of what rays from pixels have found, 4 floats a pixel: sums of irradiance / pi / scale
// and openness; their means; sums of what lobes mirror, in cd/m^2 times the share that is
// reflected, and of those shares; their quotients. The latter two only where there is gloss.
#define GATHERED_LIGHT         0
#define GATHERED_LIGHT_MEANS   1
#define GATHERED_GLOSS         2
#define GATHERED_GLOSS_MEANS   3
#define GATHERED_WITHOUT_GLOSS 2
#define GATHERED_PICTURES      4

#endif
