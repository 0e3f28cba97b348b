// Shading models, in C and GLSL.
#ifndef VOXCAST_SHADERS_SHARED_SHADING_MODEL_H
#define VOXCAST_SHADERS_SHARED_SHADING_MODEL_H

#define SHADE_PBR         0u
#define SHADE_BLINN_PHONG 1u
#define SHADE_UNLIT       2u
#define SHADE_BACKGROUND  3u

#endif
