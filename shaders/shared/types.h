// Lets C and GLSL share block structs. Members are mat4, vec4, scalars, uvec2, or a vec3 or ivec3
// followed by a scalar, in groups of 16 bytes: std140, std430 and C then agree on every offset. A
// test compares the offsets with the driver's.
#ifndef VOXCAST_SHADERS_SHARED_TYPES_H
#define VOXCAST_SHADERS_SHARED_TYPES_H

#ifdef __STDC__
#include <assert.h>
#include <cglm/cglm.h>
#include <stdint.h>
typedef uint32_t uint;
typedef uint32_t uvec2[2];
#define BLOCK_STRUCT(name) struct name
#define BLOCK_SIZE(block, vectors)                                                                 \
    static_assert(sizeof(struct block) == (vectors) * sizeof(vec4), #block " has no padding")
#else
#define BLOCK_STRUCT(name) name
#endif

#endif
