// Culls lights of limited range per screen tile.
#include "renderer/passes/pass.h"

static const char *light_tiles_skip_reason(const struct frame *frame)
{
    if (!frame_has(frame, EFFECT_LIGHT_TILES))
        return "no light of limited range";
    if (!frame_lights_pixels(frame) && frame->params->debug_view != DEBUG_VIEW_LIGHTS_PER_TILE)
        return "the debug view shows no light";
    return NULL;
}

static bool light_tiles_run(struct frame *frame, const struct pass *pass, struct error *out_error)
{
    const struct gpu_program *program =
        pass_program(frame, pass, "light/light_tiles.comp", "", out_error);
    if (!program)
        return false;
    gpu_dispatch(frame->gpu, program, frame->tiles_x, frame->tiles_y, 1);
    return true;
}

const struct pass light_tiles_pass = {
    .name = "light_tiles",
    .effects_used = EFFECT_BIT(EFFECT_TRANSPARENCY),
    .reads = RESOURCE(DEPTH) | RESOURCE(LIGHTS),
    .writes = RESOURCE(LIGHT_MASKS),
    .skip_reason = light_tiles_skip_reason,
    .run = light_tiles_run,
};
