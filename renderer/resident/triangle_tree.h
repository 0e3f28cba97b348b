// A tree of boxes over a scene's triangles as the GPU reads it, for rays against the real geometry.
#ifndef VOXCAST_RENDERER_RESIDENT_TRIANGLE_TREE_H
#define VOXCAST_RENDERER_RESIDENT_TRIANGLE_TREE_H

#include "renderer/gpu/texture.h"

struct resident;

struct triangle_tree {
    struct gpu_texture *nodes;     // layouts: see TREE_ in shaders/shared/bvh.h
    struct gpu_texture *triangles; // in world space, relative to `center`
    float center[3];
    uint32_t triangle_count;
    uint64_t key; // of what it was made from
};

// Of the visible triangles that light does not pass through; degenerate ones are left out. Cost: a
// build by all processors, some 0.1 s for 250,000 triangles. NULL when memory ends.
struct triangle_tree *triangle_tree_create(const struct resident *resident);
void triangle_tree_destroy(struct triangle_tree **tree);

#endif
