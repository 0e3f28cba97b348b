// Emitted radiance only, for scenes without other light.
#include "renderer/passes/pass.h"

static bool emission_run(struct frame *frame, const struct pass *pass, struct error *out_error)
{
    return pass_run_pixels(frame, pass, 0, out_error);
}

const struct pass emission_pass = {
    .reads = RESOURCE(DEPTH) | RESOURCE(GBUFFER),
    .writes = RESOURCE(RADIANCE),
    .program_count = 1,
    .programs = {{"light/emission.comp", 0, 0, NULL}},
    .run = emission_run,
};
