// A texture of a material, in C and GLSL.
#ifndef VOXCAST_SHADERS_SHARED_TEXTURE_BLOCK_H
#define VOXCAST_SHADERS_SHARED_TEXTURE_BLOCK_H

#include "shared/types.h"

// Bits of texture_block.sampling: flags, wrap modes (two bits each: 0 repeat, 1 clamp, 2 mirror),
// log2 of the edge, class, layer.
#define TEXTURE_UV_SET_1   1u
#define TEXTURE_NEAREST    2u
#define TEXTURE_WRAP_U_BIT 2
#define TEXTURE_WRAP_V_BIT 4
#define TEXTURE_EDGE_BIT   8
#define TEXTURE_CLASS_BIT  12
#define TEXTURE_LAYER_BIT  16

struct texture_block {
    vec3 uv_row_u; // u' = dot(row, (u, v, 1))
    float unused_0;
    vec3 uv_row_v;
    float unused_1;
    uint sampling;
    uint unused_2;
    uint unused_3;
    uint unused_4;
};

#ifdef __STDC__
BLOCK_SIZE(texture_block, 3);
#endif

#endif
