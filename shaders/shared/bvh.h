// Layout of the BVH over the scene's triangles, in C and GLSL.
#ifndef VOXCAST_SHADERS_SHARED_BVH_H
#define VOXCAST_SHADERS_SHARED_BVH_H

// BVH for rays: BVH_NODE_TEXELS texels of 4 words per node and BVH_TRIANGLE_TEXELS per triangle. A
// node stores for each of two children: lower corner and child, upper corner. A child is a node, or
// BVH_LEAF | first triangle << BVH_COUNT_BITS | triangle count. A triangle stores: first corner and
// visibility id; edge from there and mean opacity; the other edge and flags.
#define BVH_NODE_TEXELS     4
#define BVH_TRIANGLE_TEXELS 3
#define BVH_LEAF            0x80000000u
#define BVH_COUNT_BITS      3
#define BVH_MAX_DEPTH       48
#define BVH_LIT_DIRECTLY    1u // sampled directly as a planar emitter
#define BVH_ONE_SIDED       2u // blocks light on its back but emits none there

#endif
