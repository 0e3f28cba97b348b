// One frame of one view, as GI and the passes use it: plain data and what follows from it alone.
#ifndef VOXCAST_RENDERER_FRAME_FRAME_H
#define VOXCAST_RENDERER_FRAME_FRAME_H

#include "renderer/frame/effects.h"
#include "renderer/settings.h"

struct gpu;
struct gpu_scene;
struct view;
struct voxel_volume;

// What a frame has to do for its view's volume.
struct voxel_light_work {
    bool voxelize;
    bool relight;
    bool direct;            // inject direct light, too, not only the cache's bounce
    bool fresh_only;        // only cells that have not been lit yet
    uint32_t relight_first; // levels first to end - 1
    uint32_t relight_end;
    bool trace;
};

// One frame of one view, passed through all passes.
struct frame {
    struct gpu *gpu;
    struct gpu_scene *gpu_scene;
    struct view *view;
    const struct frame_params *params;
    struct view_camera camera; // that of `params`, relative to the GPU scene's origin
    struct effect_plan plan;
    const struct quality_level *quality;
    uint32_t width; // rendered size
    uint32_t height;
    uint32_t tiles_x;
    uint32_t tiles_y;
    bool visibility_changed;     // by camera, size, geometry, placement or materials
    uint32_t gi_capabilities;    // of the method: enum gi_capability
    struct voxel_volume *volume; // NULL if no effect needs voxels
    uint32_t voxel_level_count;  // levels of the volume
    bool light_converged;        // the volume's light has converged
    struct voxel_light_work light_work;
    enum gather_mode gather;
    bool accumulate;                // add a sample; else the accumulation is still valid as it is
    bool unchanged;                 // parameters and scene equal those of the frame before
    bool accumulate_only;           // adds samples or converges light, and keeps the last image
    uint32_t accumulation_target;   // samples to accumulate
    uint32_t accumulated_samples;   // including this frame's
    const float *reference_picture; // 4 floats per pixel, shown instead; NULL for none
};

// Whether there are filtered voxels that cones can be traced through.
static inline bool frame_has_cones(const struct frame *frame)
{
    return (frame->gi_capabilities & GI_HAS_CONES) && frame->volume;
}

static inline bool frame_has(const struct frame *frame, enum effect effect)
{
    return (frame->plan.bits & EFFECT_BIT(effect)) != 0;
}

// Whether soft shadows are traced with cones towards the lights.
static inline bool frame_has_cone_shadows(const struct frame *frame)
{
    return frame_has_cones(frame) && frame_has(frame, EFFECT_SOFT_SHADOWS) &&
           frame->quality->cone_shadows;
}

// Whether pixels get direct light; other debug views show something else.
static inline bool frame_lights_pixels(const struct frame *frame)
{
    return frame->params->debug_view == DEBUG_VIEW_FINAL ||
           frame->params->debug_view == DEBUG_VIEW_DIRECT;
}

// The final gather mode that settings and quality choose once light has converged.
enum gather_mode frame_gather_mode(const struct frame *frame);

// Every how many-th pixel gathers, in x and in y.
uint32_t frame_gather_step(const struct frame *frame);

// Rays sample every light up to this number. With more lights, hits are lit from the voxels and
// soft shadows are left to cones.
#define FRAME_MAX_RAY_LIGHTS 16u

// Number of accumulation planes (PLANE_ of shaders/shared/ray_accumulation.h), without the
// full-resolution shadow plane.
uint32_t frame_accumulation_planes(const struct frame *frame);

// Whether visibility of area and sphere lights is traced by rays once light has converged (wants),
// and whether this frame shows it (traces).
bool frame_wants_ray_shadows(const struct frame *frame);
bool frame_traces_shadows(const struct frame *frame);

// Defines of shaders that write or read that visibility.
#define FRAME_VISIBILITY_DEFINES_LENGTH 96
void frame_write_visibility_defines(const struct frame *frame,
                                    char out_defines[FRAME_VISIBILITY_DEFINES_LENGTH]);

// Voxel level that a debug view shows.
uint32_t frame_debug_level(const struct frame *frame);

#endif
