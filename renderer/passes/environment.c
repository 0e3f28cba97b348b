// Environment as background and ambient light. Where it runs, it is the first pass to write
// radiance.
#include "renderer/passes/pass.h"

static bool environment_run(struct frame *frame, const struct pass *pass, struct error *out_error)
{
    return pass_run_pixels(frame, pass, 0, out_error);
}

const struct pass environment_pass = {
    .reads = RESOURCE(GBUFFER) | RESOURCE(DEPTH) | RESOURCE(ENVIRONMENT) | RESOURCE(SCENE_TABLES),
    .writes = RESOURCE(RADIANCE),
    .program_count = 1,
    .programs = {{"light/environment.comp",
                  EFFECT_BIT(EFFECT_BLINN_PHONG) | EFFECT_BIT(EFFECT_SPECULAR) |
                      EFFECT_BIT(EFFECT_INDIRECT_DIFFUSE),
                  0, NULL}},
    .run = environment_run,
};
