// One frame of one view, as GI and passes work on it: plain data, and what follows from it alone.
#ifndef VOXCAST_RENDERER_FRAME_FRAME_H
#define VOXCAST_RENDERER_FRAME_FRAME_H

#include "renderer/frame/effects.h"
#include "renderer/settings.h"

struct gpu;
struct gpu_scene;
struct view;
struct voxel_volume;

// What a frame of a view has to do for its volume.
struct voxel_light_work {
    bool voxelize;
    bool relight;
    bool direct;            // by lights, too, rather than by the cache alone
    bool fresh_only;        // only cells that have not been lit before
    uint32_t relight_first; // levels
    uint32_t relight_end;
    bool trace;
};

// One frame of one view on its way through the passes.
struct frame {
    struct gpu *gpu;
    struct gpu_scene *gpu_scene;
    struct view *view;
    const struct frame_params *params;
    struct view_camera camera; // that of `params`, but placed about the resident's origin
    struct effect_plan plan;
    const struct quality_level *quality;
    uint32_t width; // rendered
    uint32_t height;
    uint32_t tiles_x;
    uint32_t tiles_y;
    bool visibility_changed;     // camera, size, geometry, placement or materials
    struct voxel_volume *volume; // NULL where no effect needs voxels
    uint32_t voxel_level_count;  // of the volume
    bool light_converged;        // in the volume
    struct voxel_light_work light_work;
    enum gather_mode gather;
    bool accumulate;                // pixels' cones are due; else what they found is still good
    bool unchanged;                 // parameters and document are those of the frame before
    bool accumulate_only;           // adds light or rays to those of before: the picture stays
    uint32_t accumulation_target;   // pictures to average
    uint32_t accumulated_samples;   // this one and those before it
    const float *reference_picture; // 4 floats a pixel, shown instead; NULL for none
};

static inline bool frame_has(const struct frame *frame, enum effect effect)
{
    return (frame->plan.bits & EFFECT_BIT(effect)) != 0;
}

// Whether cones towards lights that have a size tell their shadows.
static inline bool frame_has_cone_shadows(const struct frame *frame)
{
    return frame->volume && frame_has(frame, EFFECT_SOFT_SHADOWS) && frame->quality->cone_shadows;
}

// Whether pixels are lit directly: other debug views show something else.
static inline bool frame_lights_pixels(const struct frame *frame)
{
    return frame->params->debug_view == DEBUG_VIEW_FINAL ||
           frame->params->debug_view == DEBUG_VIEW_DIRECT;
}

// How pixels of the frame gather in the end, as settings and quality say.
enum gather_mode frame_gather_mode(const struct frame *frame);

// Every how many-th pixel gathers, in both directions.
uint32_t frame_gather_step(const struct frame *frame);

// Rays ask each light of a scene, up to so many. Where there are more, what they meet is lit as
// voxels are, and soft shadows are left to cones.
#define FRAME_MAX_RAY_LIGHTS 16u

// Number of accumulation planes (PLANE_ of shaders/shared/ray_accumulation.h), without the
// full-resolution plane of shadows.
uint32_t frame_accumulation_planes(const struct frame *frame);

// Whether shadows of lights that have a size are traced in the end; and in this frame shown.
bool frame_wants_ray_shadows(const struct frame *frame);
bool frame_traces_shadows(const struct frame *frame);

// For shaders that write or read what those rays have found.
#define FRAME_VISIBILITY_DEFINES_LENGTH 96
void frame_write_visibility_defines(const struct frame *frame,
                                    char out_defines[FRAME_VISIBILITY_DEFINES_LENGTH]);

// The voxel level that a debug view shows.
uint32_t frame_debug_level(const struct frame *frame);

#endif
