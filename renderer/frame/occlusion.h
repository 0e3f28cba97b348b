// Occlusion culling in two passes, for CPU drivers, where a triangle costs 0.14 us even if nothing
// of it is seen. The first draws the blocks of triangles of which the last frame showed any; the
// second those others whose boxes are not behind what the first has drawn (Haar and Aaltonen 2015,
// "GPU-Driven Rendering Pipelines"). So nothing is missing, however the camera or the scene has
// moved: what the last frame showed is only a guess. Of surfaces at exactly the same depth, the one
// that was seen before stays. Where little is hidden, frames are drawn in one pass.
#ifndef VOXCAST_RENDERER_FRAME_OCCLUSION_H
#define VOXCAST_RENDERER_FRAME_OCCLUSION_H

#include "renderer/frame/draw_list.h"

struct occlusion {
    struct draw_list list; // of the pass that is being drawn
    uint8_t *seen;         // a byte for each block: the last frame showed it
    uint32_t block_count;
    bool has_seen;         // any
    uint32_t frames_until; // it is tried again
    uint32_t width;
    uint32_t height;
    uint32_t *pixels; // ids or depths of the view
    float *farthest;  // depth, of tiles and then of coarser and coarser levels
};

void occlusion_finish(struct occlusion *occlusion);

// Whether two passes are likely to cost less than one. `triangles`: what the camera's frustum
// leaves.
bool occlusion_pays(struct occlusion *occlusion, const struct gpu_scene *gpu_scene,
                    uint32_t triangles);

// Judges by what two passes have drawn of them whether the next frames try it, too.
void occlusion_judge(struct occlusion *occlusion, uint32_t drawn, uint32_t triangles);

// Whether the last frame says anything. If not, draw all, and then call occlusion_note_seen().
bool occlusion_has_seen(const struct occlusion *occlusion, const struct gpu_scene *gpu_scene);

// List the triangles of the first and of the second pass; `depth` is what the first has drawn.
// False when memory runs out.
bool occlusion_list_seen(struct occlusion *occlusion, const struct gpu_scene *gpu_scene,
                         const mat4 clip_from_world, const float *eye);
bool occlusion_list_rest(struct occlusion *occlusion, const struct gpu_scene *gpu_scene,
                         const mat4 clip_from_world, const float *eye,
                         const struct gpu_texture *depth, uint32_t width, uint32_t height);

// Remembers for the next frame what this one shows. False when memory runs out.
bool occlusion_note_seen(struct occlusion *occlusion, const struct gpu_scene *gpu_scene,
                         const struct gpu_texture *ids, uint32_t width, uint32_t height);

#endif
