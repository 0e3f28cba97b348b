// Injects light into occupied voxels: direct light, emission, and the cache's bounce.
#include <stdio.h>

#include "renderer/gi/voxel/volume.h"
#include "renderer/passes/pass.h"

static const char *voxel_relight_skip_reason(const struct frame *frame)
{
    if (!frame_has_cones(frame))
        return "no effect needs voxels";
    return frame->light_work.relight ? NULL : "light in voxels unchanged";
}

static bool voxel_relight_run(struct frame *frame, const struct pass *pass, struct error *out_error)
{
    struct voxel_volume *volume = frame->volume;
    bool feeds = frame_has(frame, EFFECT_MULTI_BOUNCE) && volume->light.feeds;
    char extra[128];
    snprintf(extra, sizeof(extra),
             "LIGHT_TILES 0\nSPECULAR 0\nBLINN_PHONG 0\nTAPS 4\nMULTI_BOUNCE %d\nFRESH %d\n", feeds,
             frame->light_work.fresh_only);
    const struct gpu_program *program = voxel_program(
        frame, pass,
        frame->light_work.direct ? "voxel/voxel_relight.comp" : "voxel/voxel_inject_bounce.comp",
        extra, out_error);
    if (!program)
        return false;
    voxel_volume_choose_levels(volume, frame->light_work.relight_first,
                               frame->light_work.relight_end);
    gpu_dispatch_indirect(frame->gpu, program, volume->counters, COUNTER_LISTS * 4);
    return true;
}

const struct pass voxel_relight_pass = {
    .name = "voxel_relight",
    .effects_used = EFFECT_BIT(EFFECT_SHADOWS) | EFFECT_BIT(EFFECT_SINGLE_VIEW_SHADOWS) |
                    EFFECT_BIT(EFFECT_POINT_SHADOWS) | EFFECT_BIT(EFFECT_PUNCTUAL_LIGHTS) |
                    EFFECT_BIT(EFFECT_AREA_LIGHTS) | EFFECT_BIT(EFFECT_INDIRECT_DIFFUSE) |
                    EFFECT_BIT(EFFECT_VOXEL_COLORS),
    .runs_while_accumulating = true,
    // Also reads the irradiance cache, as an earlier frame left it.
    .reads = RESOURCE(VOXELS) | RESOURCE(SHADOW_MAP) | RESOURCE(LIGHTS) | RESOURCE(MATERIALS),
    .writes = RESOURCE(VOXEL_RADIANCE) | RESOURCE(IRRADIANCE),
    .skip_reason = voxel_relight_skip_reason,
    .run = voxel_relight_run,
};
