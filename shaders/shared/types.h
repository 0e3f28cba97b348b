// Lets C and GLSL read the same block structs. Only mat4, vec4, uvec4 and ivec4 are used, so that
// std140, std430 and C agree on every offset.
#ifndef VOXCAST_SHADERS_SHARED_TYPES_H
#define VOXCAST_SHADERS_SHARED_TYPES_H

#ifdef __STDC__
#include <assert.h>
#include <cglm/cglm.h>
#include <stdint.h>
typedef uint32_t uvec4[4];
#endif

#endif
