// A planar emitter, in C and GLSL.
#ifndef VOXCAST_SHADERS_SHARED_AREA_LIGHT_BLOCK_H
#define VOXCAST_SHADERS_SHARED_AREA_LIGHT_BLOCK_H

#include "shared/shadow_view_block.h"

#define MAX_AREA_LIGHTS 16

// Up to four corners, counter-clockwise seen from the lit side.
struct area_light_block {
    vec4 corners[4]; // world; the fourth component is unused
    vec3 radiance;   // cd/m^2
    float area_m2;
    vec3 center;
    uint in_voxels; // 1: lit from voxels instead, if there are any
    vec3 normal;    // unit
    uint two_sided; // 1 if both sides emit
    BLOCK_STRUCT(light_shadow) shadow;
};

#ifdef __STDC__
BLOCK_SIZE(area_light_block, 8);
#endif

#endif
