#include "renderer/frame/frame.h"

#include <stdio.h>

#include "renderer/gpu_scene/gpu_scene.h"
#include "shared/ray_accumulation.h"

enum gather_mode frame_gather_mode(const struct frame *frame)
{
    enum gather_mode chosen = frame->params->settings.gather_mode;
    return chosen == GATHER_AUTO ? frame->quality->gather_mode : chosen;
}

uint32_t frame_gather_step(const struct frame *frame)
{
    enum gather_mode mode = frame_gather_mode(frame);
    return mode == GATHER_HALF ? 2 : mode == GATHER_RAYS ? frame->quality->ray_step : 1;
}

uint32_t frame_accumulation_planes(const struct frame *frame)
{
    if (frame_gather_mode(frame) != GATHER_RAYS)
        return 1;
    return frame_has(frame, EFFECT_INDIRECT_SPECULAR) ? PLANES_WITH_SPECULAR
                                                      : PLANES_WITHOUT_SPECULAR;
}

bool frame_wants_ray_shadows(const struct frame *frame)
{
    return frame_has_cones(frame) && frame_gather_mode(frame) == GATHER_RAYS &&
           frame_has(frame, EFFECT_SOFT_SHADOWS) &&
           frame->gpu_scene->counts.lights <= FRAME_MAX_RAY_LIGHTS;
}

bool frame_traces_shadows(const struct frame *frame)
{
    return frame_wants_ray_shadows(frame) && frame->gather == GATHER_RAYS;
}

void frame_write_visibility_defines(const struct frame *frame,
                                    char out_defines[FRAME_VISIBILITY_DEFINES_LENGTH])
{
    bool rays = frame_traces_shadows(frame);
    snprintf(out_defines, FRAME_VISIBILITY_DEFINES_LENGTH,
             "RAY_SHADOWS %d\nCONE_SHADOWS %d\nGATHER_STEP %u\nVISIBILITY_PLANE %u\n", rays,
             !rays && frame_has_cone_shadows(frame), frame_gather_step(frame),
             frame_accumulation_planes(frame));
}

uint32_t frame_debug_level(const struct frame *frame)
{
    uint32_t wanted = frame->params->debug_level;
    uint32_t count = frame_has_cones(frame) ? frame->voxel_level_count : 1;
    return wanted < count ? wanted : count - 1;
}
