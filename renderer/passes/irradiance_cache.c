// Traces the cones of requested voxel faces, within the frame's budget.
#include "renderer/gi/voxel/volume.h"
#include "renderer/passes/pass.h"
#include "renderer/frame/view.h"

#define MOVING_SMOOTH_FRAMES 4u
#define REQUEST_EDGE         4u // as in shaders/gi/cache_request.comp

static const char *irradiance_cache_skip_reason(const struct frame *frame)
{
    if (!frame_has_cones(frame))
        return "no effect needs voxels";
    if (!frame_has(frame, EFFECT_INDIRECT_DIFFUSE))
        return "no surface passes light on";
    return frame->light_work.trace ? NULL : "irradiance has converged";
}

static bool irradiance_cache_run(struct frame *frame, const struct pass *pass,
                                 struct error *out_error)
{
    struct voxel_volume *volume = frame->volume;
    const struct gpu_program *request =
        voxel_program(frame, pass, "gi/cache_request.comp", "", out_error);
    const struct gpu_program *select = request ? voxel_program(frame, pass, "gi/cache_select.comp",
                                                               "STAGE SELECT_FACES\n", out_error)
                                               : NULL;
    const struct gpu_program *arguments = select
                                              ? voxel_program(frame, pass, "gi/cache_select.comp",
                                                              "STAGE SELECT_ARGUMENTS\n", out_error)
                                              : NULL;
    const struct gpu_program *gather = arguments
                                           ? voxel_program(frame, pass, "gi/cache_trace.comp",
                                                           "PIXEL_CONES 0\nMARCH 0\n", out_error)
                                           : NULL;
    const struct gpu_program *march = gather ? voxel_program(frame, pass, "gi/cache_trace.comp",
                                                             "PIXEL_CONES 0\nMARCH 1\n", out_error)
                                             : NULL;
    const struct gpu_program *smooth =
        march ? voxel_program(frame, pass, "gi/cache_smooth.comp", "", out_error) : NULL;
    if (!smooth)
        return false;
    gpu_buffer_fill(volume->counters, COUNTER_CACHE_CLASSES * 4, CACHE_CLASSES * 4, 0);
    uint32_t pixels = GROUP_EDGE * REQUEST_EDGE;
    gpu_dispatch(frame->gpu, request, (frame->width + pixels - 1) / pixels,
                 (frame->height + pixels - 1) / pixels, 1);
    gpu_barrier(frame->gpu);
    gpu_dispatch_indirect(frame->gpu, select, volume->counters, COUNTER_LISTS * 4);
    gpu_barrier(frame->gpu);
    gpu_dispatch(frame->gpu, arguments, 1, 1, 1);
    gpu_barrier(frame->gpu);
    gpu_dispatch_indirect(frame->gpu, gather, volume->counters, COUNTER_LOOKUP * 4);
    gpu_barrier(frame->gpu);
    gpu_dispatch_indirect(frame->gpu, march, volume->counters, COUNTER_MARCH * 4);
    gpu_barrier(frame->gpu);
    // Smoothing visits all faces, so while the camera moves it runs only every few frames.
    if (!frame->visibility_changed || volume->frame % MOVING_SMOOTH_FRAMES == 0)
        gpu_dispatch_indirect(frame->gpu, smooth, volume->counters, COUNTER_LISTS * 4);
    return true;
}

const struct pass irradiance_cache_pass = {
    .name = "irradiance_cache",
    .effects_used = EFFECT_BIT(EFFECT_ENVIRONMENT_LIGHT) | EFFECT_BIT(EFFECT_CLIP_LEVELS),
    .runs_while_accumulating = true,
    .reads = RESOURCE(GBUFFER) | RESOURCE(VOXELS) | RESOURCE(VOXEL_RADIANCE) | RESOURCE(DEPTH) |
             RESOURCE(ENVIRONMENT),
    .writes = RESOURCE(IRRADIANCE),
    .skip_reason = irradiance_cache_skip_reason,
    .run = irradiance_cache_run,
};
