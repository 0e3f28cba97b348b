// Culls lights of limited range per screen tile.
#include "renderer/passes/pass.h"

static bool light_tiles_run(struct frame *frame, const struct pass *pass, struct error *out_error)
{
    const struct gpu_program *program = pass_program(frame, pass, 0, out_error);
    if (!program)
        return false;
    gpu_dispatch(frame->gpu, program, frame->plan->tiles_x, frame->plan->tiles_y, 1);
    return true;
}

const struct pass light_tiles_pass = {
    .reads = RESOURCE(DEPTH) | RESOURCE(SCENE_TABLES),
    .writes = RESOURCE(LIGHT_MASKS),
    .program_count = 1,
    .programs = {{"light/light_tiles.comp", EFFECT_BIT(EFFECT_TRANSPARENCY), 0, NULL}},
    .run = light_tiles_run,
};
