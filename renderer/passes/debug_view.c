// Pictures of what the renderer works with, in place of light.
#include "renderer/passes/pass.h"
#include "renderer/view.h"

static const char *debug_view_skip_reason(const struct frame *frame)
{
    return !frame_shows_light(frame) ? NULL : "no debug view chosen";
}

static bool debug_view_run(struct frame *frame, const struct pass *pass, struct error *out_error)
{
    const struct gpu_program *program =
        pass_program(frame, pass, "debug/debug_view.comp", "", out_error);
    if (!program)
        return false;
    pass_dispatch_pixels(frame, program);
    return true;
}

const struct pass debug_view_pass = {
    .name = "debug_view",
    .effects_used = EFFECT_BIT(EFFECT_FLAT_SHADOWS) | EFFECT_BIT(EFFECT_CUBE_SHADOWS) |
                    EFFECT_BIT(EFFECT_LIGHT_TILES),
    .use_count = 5,
    .uses = {{RESOURCE_IDS, ACCESS_READ},
             {RESOURCE_DEPTH, ACCESS_READ},
             {RESOURCE_GBUFFER, ACCESS_READ},
             {RESOURCE_LIGHT_MASKS, ACCESS_READ},
             {RESOURCE_RADIANCE, ACCESS_WRITE}},
    .skip_reason = debug_view_skip_reason,
    .run = debug_view_run,
};
