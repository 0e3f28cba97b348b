// A view of the shadow map, and the views of a light, in C and GLSL.
#ifndef VOXCAST_SHADERS_SHARED_SHADOW_VIEW_BLOCK_H
#define VOXCAST_SHADERS_SHARED_SHADOW_VIEW_BLOCK_H

#include "shared/types.h"

#define NO_SHADOW 0xffffffffu

#define MAX_SHADOW_LAYERS 32

// Cube faces and spots are a little wider than needed, for the filter taps at the rim.
#define SHADOW_FACE_MARGIN 1.02f

struct light_shadow {
    uint first_view; // or NO_SHADOW
    uint view_count; // 1; 6 for a cube
    uint light_id;   // light's id in the scene
    uint has_cascades;
};

struct shadow_view_block {
    mat4 clip_from_world;
    float texel_m;       // world size of a texel; for perspective views at distance 1
    uint perspective;    // 1; 0 if directional
    float depth_range_m; // directional: metres per unit of depth; perspective: near plane
    float unused;
};

#ifdef __STDC__
BLOCK_SIZE(shadow_view_block, 5);
#endif

#endif
