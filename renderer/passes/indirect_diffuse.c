// Indirect diffuse light: from the irradiance cache, or by cones or rays at pixels.
#include <stdio.h>

#include "renderer/gi/voxel/volume.h"
#include "renderer/passes/pass.h"
#include "renderer/frame/view.h"

static const char *indirect_diffuse_skip_reason(const struct frame *frame)
{
    if (!frame_has_cones(frame) || !frame_has(frame, EFFECT_INDIRECT_DIFFUSE))
        return frame->view->last_plan.reasons[EFFECT_INDIRECT_DIFFUSE];
    bool shown = frame->params->debug_view == DEBUG_VIEW_FINAL ||
                 frame->params->debug_view == DEBUG_VIEW_INDIRECT_DIFFUSE;
    return shown ? NULL : "the debug view shows none";
}

static bool trace_pixel_rays(const struct frame *frame, const struct pass *pass,
                             struct error *out_error)
{
    const struct gpu_program *program = hit_program(frame, pass, "gi/ray_diffuse.comp", out_error);
    if (!program)
        return false;
    uint32_t pixels = frame_gather_step(frame) * GROUP_EDGE;
    gpu_dispatch(frame->gpu, program, (frame->width + pixels - 1) / pixels,
                 (frame->height + pixels - 1) / pixels, 1);
    gpu_barrier(frame->gpu);
    return filter_accumulation(frame, pass, false, out_error);
}

static bool trace_pixel_cones(const struct frame *frame, const struct pass *pass, const char *extra,
                              struct error *out_error)
{
    const struct gpu_program *program =
        voxel_program(frame, pass, "gi/pixel_cones.comp", extra, out_error);
    if (!program)
        return false;
    uint32_t pixels = frame_gather_step(frame) * GROUP_EDGE;
    gpu_dispatch(frame->gpu, program, (frame->width + pixels - 1) / pixels,
                 (frame->height + pixels - 1) / pixels, 1);
    gpu_barrier(frame->gpu);
    return true;
}

static bool indirect_diffuse_run(struct frame *frame, const struct pass *pass,
                                 struct error *out_error)
{
    bool cached = frame->gather == GATHER_CACHE, rays = frame->gather == GATHER_RAYS;
    bool alone = frame->params->debug_view == DEBUG_VIEW_INDIRECT_DIFFUSE;
    char extra[64];
    snprintf(extra, sizeof(extra), "CACHED %d\nGATHER_STEP %u\nFILTERED %d\nALONE %d\n", cached,
             frame_gather_step(frame), rays, alone);
    if (!cached && frame->accumulate &&
        !(rays ? trace_pixel_rays(frame, pass, out_error)
               : trace_pixel_cones(frame, pass, extra, out_error)))
        return false;
    if (frame->accumulate_only)
        return true;
    const struct gpu_program *program =
        voxel_program(frame, pass, "gi/indirect_diffuse.comp", extra, out_error);
    if (!program)
        return false;
    uint32_t pixels = cached ? 2 * GROUP_EDGE : GROUP_EDGE;
    gpu_dispatch(frame->gpu, program, (frame->width + pixels - 1) / pixels,
                 (frame->height + pixels - 1) / pixels, 1);
    return true;
}

const struct pass indirect_diffuse_pass = {
    .name = "indirect_diffuse",
    .effects_used = EFFECT_BIT(EFFECT_SPECULAR) | EFFECT_BIT(EFFECT_CLIP_LEVELS) |
                    EFFECT_BIT(EFFECT_AMBIENT_OCCLUSION) | EFFECT_BIT(EFFECT_ENVIRONMENT_LIGHT) |
                    EFFECT_BIT(EFFECT_INDIRECT_SPECULAR),
    .runs_while_accumulating = true,
    .reads = HIT_READS | RESOURCE(GBUFFER) | RESOURCE(DEPTH) | RESOURCE(VOXELS) |
             RESOURCE(IRRADIANCE) | RESOURCE(RADIANCE) | RESOURCE(ENVIRONMENT),
    .writes = RESOURCE(RADIANCE) | RESOURCE(ACCUMULATION),
    .skip_reason = indirect_diffuse_skip_reason,
    .run = indirect_diffuse_run,
};
