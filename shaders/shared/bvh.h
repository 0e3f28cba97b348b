// Layout of the bounding volume hierarchy over the scene's triangles, for C and GLSL.
#ifndef VOXCAST_SHADERS_SHARED_BVH_H
#define VOXCAST_SHADERS_SHARED_BVH_H

// A tree of boxes over the scene's triangles, for rays: TREE_NODE_TEXELS texels of 4 words a node
// and TREE_TRIANGLE_TEXELS a triangle, in rows of 2^TREE_ROW_BITS texels. A node has for each of
// two children lower corner and child, upper corner. A child is a node, or TREE_LEAF | first
// triangle << TREE_COUNT_BITS | triangles. A triangle has its first corner and visibility id, then
// an edge from there and mean opacity, then the other edge and flags.
#define TREE_ROW_BITS        12
#define TREE_NODE_TEXELS     4
#define TREE_TRIANGLE_TEXELS 3
#define TREE_LEAF            0x80000000u
#define TREE_COUNT_BITS      3
#define TREE_MAX_DEPTH       48
#define TREE_LIT_DIRECTLY    1u // its emission reaches others as a planar emitter's
#define TREE_ONE_SIDED       2u // stops light on its back, but sends none

#endif
