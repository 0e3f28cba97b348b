// Layout of the bounding volume hierarchy over the scene's triangles, for C and GLSL.
#ifndef VOXCAST_SHADERS_SHARED_BVH_H
#define VOXCAST_SHADERS_SHARED_BVH_H

// A tree of boxes over the scene's triangles, for rays: BVH_NODE_TEXELS texels of 4 words a node
// and BVH_TRIANGLE_TEXELS a triangle, in rows of 2^BVH_ROW_BITS texels. A node has for each of
// two children lower corner and child, upper corner. A child is a node, or BVH_LEAF | first
// triangle << BVH_COUNT_BITS | triangles. A triangle has its first corner and visibility id, then
// an edge from there and mean opacity, then the other edge and flags.
#define BVH_ROW_BITS        12
#define BVH_NODE_TEXELS     4
#define BVH_TRIANGLE_TEXELS 3
#define BVH_LEAF            0x80000000u
#define BVH_COUNT_BITS      3
#define BVH_MAX_DEPTH       48
#define BVH_LIT_DIRECTLY    1u // its emission reaches others as a planar emitter's
#define BVH_ONE_SIDED       2u // stops light on its back, but sends none

#endif
