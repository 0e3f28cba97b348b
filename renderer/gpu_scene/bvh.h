// A tree of boxes over a scene's triangles as the GPU reads it, for rays against the real geometry.
#ifndef VOXCAST_RENDERER_GPU_SCENE_BVH_H
#define VOXCAST_RENDERER_GPU_SCENE_BVH_H

#include "renderer/gpu/texture.h"

struct gpu_scene;

struct bvh {
    struct gpu_texture *nodes;     // layouts: see TREE_ in shaders/shared/bvh.h
    struct gpu_texture *triangles; // in world space, relative to `center`
    float center[3];
    uint32_t triangle_count;
    uint64_t key; // of what it was made from
};

// Of the visible triangles that light does not pass through; degenerate ones are left out. Cost: a
// build by all processors, some 0.1 s for 250,000 triangles. NULL when memory ends.
struct bvh *bvh_create(const struct gpu_scene *gpu_scene);
void bvh_destroy(struct bvh **bvh);

#endif
