// One frame of one view, as GI and the passes use it.
#ifndef VOXCAST_RENDERER_FRAME_FRAME_H
#define VOXCAST_RENDERER_FRAME_FRAME_H

#include "renderer/frame/frame_plan.h"

struct gpu;
struct gpu_scene;
struct view;
struct voxel_volume;

// One frame of one view, passed through all passes.
struct frame {
    struct gpu *gpu;
    struct gpu_scene *gpu_scene;
    struct view *view;
    const struct frame_params *params;
    struct view_camera camera; // that of `params`, relative to the GPU scene's origin
    struct frame_inputs inputs;
    const struct frame_plan *plan;  // the view's
    struct voxel_volume *volume;    // of methods of voxels; NULL if no effect needs voxels
    void *method_data;              // of any other method, which knows its type
    struct gi_state gi;             // of the above
    const float *reference_picture; // 4 floats per pixel, shown instead; NULL for none
};

static inline bool frame_has(const struct frame *frame, enum effect effect)
{
    return (frame->plan->effects.bits & EFFECT_BIT(effect)) != 0;
}

#endif
