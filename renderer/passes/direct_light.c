// Direct light from punctual and area lights.
#include <stdio.h>

#include "renderer/passes/pass.h"
#include "renderer/frame/view.h"
#include "shared/display.h"

static const char *direct_light_skip_reason(const struct frame *frame)
{
    if (!frame_has(frame, EFFECT_PUNCTUAL_LIGHTS) && !frame_has(frame, EFFECT_AREA_LIGHTS))
        return "no light in the scene";
    if (frame->gpu_scene->counts.lit_materials == 0 && !frame->params->settings.force_all_effects)
        return "every surface is unlit";
    return frame_lights_pixels(frame) ? NULL : "the debug view shows no light";
}

static bool direct_light_run(struct frame *frame, const struct pass *pass, struct error *out_error)
{
    // Whichever pass writes radiance first adds the emission.
    bool first = environment_pass.skip_reason(frame) != NULL;
    int added_to = frame->params->debug_view == DEBUG_VIEW_DIRECT ? ADDED_TO_NOTHING
                   : first                                        ? ADDED_TO_EMISSION
                                                                  : ADDED_TO_RADIANCE;
    char extra[FRAME_VISIBILITY_DEFINES_LENGTH + 16], visibility[FRAME_VISIBILITY_DEFINES_LENGTH];
    frame_write_visibility_defines(frame, visibility);
    snprintf(extra, sizeof(extra), "ADDED_TO %d\n%s", added_to, visibility);
    const struct gpu_program *program =
        frame_has_cones(frame)
            ? voxel_program(frame, pass, "light/direct_light.comp", extra, out_error)
            : pass_program(frame, pass, "light/direct_light.comp", extra, out_error);
    if (!program)
        return false;
    pass_dispatch_pixels(frame, program);
    return true;
}

const struct pass direct_light_pass = {
    .name = "direct_light",
    .effects_used = DIRECT_LIGHT_EFFECTS,
    .reads = RESOURCE(GBUFFER) | RESOURCE(DEPTH) | RESOURCE(SHADOW_MAP) | RESOURCE(VOXEL_RADIANCE) |
             RESOURCE(LIGHT_MASKS) | RESOURCE(RADIANCE) | RESOURCE(ACCUMULATION) |
             RESOURCE(LIGHTS) | RESOURCE(VOXELS) | RESOURCE(IRRADIANCE) | RESOURCE(ENVIRONMENT),
    .writes = RESOURCE(RADIANCE),
    .skip_reason = direct_light_skip_reason,
    .run = direct_light_run,
};
