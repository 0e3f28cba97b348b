// A punctual light (KHR_lights_punctual), in C and GLSL.
#ifndef VOXCAST_SHADERS_SHARED_LIGHT_BLOCK_H
#define VOXCAST_SHADERS_SHARED_LIGHT_BLOCK_H

#include "shared/shadow_view_block.h"

#define LIGHT_DIRECTIONAL 0u
#define LIGHT_POINT       1u
#define LIGHT_SPOT        2u

struct light_block {
    vec3 position; // world
    uint type;
    vec3 direction;   // unit, along the light's rays
    float range_m;    // 0: unlimited
    vec3 intensity;   // colour times intensity, in cd or lux
    float radius_m;   // of the emitting sphere
    float cone_scale; // of the spot's cosine
    float cone_offset;
    float cos_outer_cone;
    float unused;
    BLOCK_STRUCT(light_shadow) shadow;
};

#ifdef __STDC__
BLOCK_SIZE(light_block, 5);
#endif

#endif
