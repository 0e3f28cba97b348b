// A placed primitive (one draw), in C and GLSL.
#ifndef VOXCAST_SHADERS_SHARED_INSTANCE_BLOCK_H
#define VOXCAST_SHADERS_SHARED_INSTANCE_BLOCK_H

#include "shared/types.h"

// Flags of an instance.
#define INSTANCE_MIRRORED 1u

struct instance_block {
    mat4 world_from_local;
    uint first_triangle;
    uint material;
    uint first_visibility_id;
    uint flags;
};

#ifdef __STDC__
BLOCK_SIZE(instance_block, 5);
#endif

#endif
