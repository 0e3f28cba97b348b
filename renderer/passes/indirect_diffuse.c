// Indirect diffuse light: from the irradiance cache, or from cones at pixels.
#include "renderer/gi/volume.h"
#include "renderer/passes/pass.h"
#include "renderer/view.h"

static const char *indirect_diffuse_skip_reason(const struct frame *frame)
{
    if (!frame->volume || !frame_has(frame, EFFECT_INDIRECT_DIFFUSE))
        return frame->plan.reasons[EFFECT_INDIRECT_DIFFUSE];
    bool shown = frame->params->debug_view == DEBUG_VIEW_FINAL ||
                 frame->params->debug_view == DEBUG_VIEW_INDIRECT_DIFFUSE;
    return shown ? NULL : "the debug view shows none";
}

static bool indirect_diffuse_run(struct frame *frame, const struct pass *pass,
                                 struct error *out_error)
{
    bool alone = frame->params->debug_view == DEBUG_VIEW_INDIRECT_DIFFUSE;
    const struct gpu_program *program = voxel_program(frame, pass, "gi/indirect_diffuse.comp",
                                                      alone ? "ALONE 1\n" : "ALONE 0\n", out_error);
    if (!program)
        return false;
    uint32_t pixels = 2 * GROUP_EDGE;
    gpu_dispatch(frame->gpu, program, (frame->width + pixels - 1) / pixels,
                 (frame->height + pixels - 1) / pixels, 1);
    return true;
}

const struct pass indirect_diffuse_pass = {
    .name = "indirect_diffuse",
    .effects_used = EFFECT_BIT(EFFECT_SPECULAR) | EFFECT_BIT(EFFECT_CLIP_LEVELS) |
                    EFFECT_BIT(EFFECT_AMBIENT_OCCLUSION),
    .use_count = 5,
    .uses = {{RESOURCE_GBUFFER, ACCESS_READ},
             {RESOURCE_DEPTH, ACCESS_READ},
             {RESOURCE_VOXELS, ACCESS_READ},
             {RESOURCE_IRRADIANCE, ACCESS_READ},
             {RESOURCE_RADIANCE, ACCESS_READ_WRITE}},
    .skip_reason = indirect_diffuse_skip_reason,
    .run = indirect_diffuse_run,
};
