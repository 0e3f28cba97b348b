// Environment as background and ambient light. Where it runs, it is the first pass to write
// radiance.
#include "renderer/passes/pass.h"

static const char *environment_skip_reason(const struct frame *frame)
{
    if (!frame_has(frame, EFFECT_ENVIRONMENT))
        return "no environment in the scene";
    return frame->params->debug_view == DEBUG_VIEW_FINAL ? NULL
                                                         : "the debug view shows no environment";
}

static bool environment_run(struct frame *frame, const struct pass *pass, struct error *out_error)
{
    const struct gpu_program *program =
        pass_program(frame, pass, "light/environment.comp", "", out_error);
    if (!program)
        return false;
    pass_dispatch_pixels(frame, program);
    return true;
}

const struct pass environment_pass = {
    .name = "environment",
    .effects_used = EFFECT_BIT(EFFECT_BLINN_PHONG) | EFFECT_BIT(EFFECT_SPECULAR) |
                    EFFECT_BIT(EFFECT_INDIRECT_DIFFUSE),
    .reads = RESOURCE(GBUFFER) | RESOURCE(DEPTH) | RESOURCE(ENVIRONMENT),
    .writes = RESOURCE(RADIANCE),
    .skip_reason = environment_skip_reason,
    .run = environment_run,
};
