// A view of the shadow map, and which views a light has, for C and GLSL.
#ifndef VOXCAST_SHADERS_SHARED_SHADOW_VIEW_BLOCK_H
#define VOXCAST_SHADERS_SHARED_SHADOW_VIEW_BLOCK_H

#include "shared/types.h"

#define NO_SHADOW 0xffffffffu

#define MAX_SHADOW_LAYERS 32

// Cube faces and spots see a little more than they need, for the filter's taps at the rim.
#define SHADOW_FACE_MARGIN 1.02f

struct light_shadow {
    uint first_view; // or NO_SHADOW
    uint view_count; // 1, or 6 of a cube
    uint light_id;   // of the document
    uint has_cascades;
};

struct shadow_view_block {
    mat4 clip_from_world;
    float texel_m;       // world size of a texel: at distance 1 if perspective, else anywhere
    uint perspective;    // 1, or 0 if directional
    float depth_range_m; // directional: metres per unit of depth; perspective: the near plane
    float unused;
};

#ifdef __STDC__
BLOCK_SIZE(shadow_view_block, 5);
#endif

#endif
