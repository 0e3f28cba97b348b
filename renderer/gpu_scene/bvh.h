// BVH over a scene's triangles in GPU buffers.
#ifndef VOXCAST_RENDERER_GPU_SCENE_BVH_H
#define VOXCAST_RENDERER_GPU_SCENE_BVH_H

#include "renderer/gpu/buffer.h"

struct gpu_scene;

struct bvh {
    struct gpu_buffer *nodes;     // layouts: BVH_ in shaders/shared/bvh.h
    struct gpu_buffer *triangles; // world, relative to `center`
    float center[3];
    uint32_t triangle_count;
    uint64_t key; // hash of what it was built from
};

// Builds from the visible triangles that block light; omits degenerate ones. Cost: all processors,
// about 0.4 s of their time for 250,000 triangles; a tenth where the scene cache may be asked
// (`cached`) and holds it. NULL when memory runs out.
struct bvh *bvh_create(const struct gpu_scene *gpu_scene, bool cached);
void bvh_destroy(struct bvh **bvh);

#endif
