// Turns visibility ids into the G-buffer.
#include "renderer/passes/pass.h"

static bool gbuffer_run(struct frame *frame, const struct pass *pass, struct error *out_error)
{
    return pass_run_pixels(frame, pass, 0, out_error);
}

const struct pass gbuffer_pass = {
    .reads = RESOURCE(IDS) | RESOURCE(DEPTH) | RESOURCE(GEOMETRY) | RESOURCE(SCENE_TABLES) |
             RESOURCE(TEXTURES),
    .writes = RESOURCE(GBUFFER),
    .program_count = 1,
    .programs = {{"visibility/gbuffer.comp", EFFECT_BIT(EFFECT_VERTEX_COLORS), TEXTURE_SWITCHES,
                  NULL}},
    .run = gbuffer_run,
};
