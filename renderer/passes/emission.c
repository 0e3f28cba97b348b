// Emitted radiance only, for scenes without other light.
#include "renderer/passes/pass.h"

static const char *emission_skip_reason(const struct frame *frame)
{
    if (!frame_lights_pixels(frame))
        return "the debug view shows no light";
    bool other = !environment_pass.skip_reason(frame) || !direct_light_pass.skip_reason(frame);
    return other ? "another light pass writes it" : NULL;
}

static bool emission_run(struct frame *frame, const struct pass *pass, struct error *out_error)
{
    const struct gpu_program *program =
        pass_program(frame, pass, "light/emission.comp", "", out_error);
    if (!program)
        return false;
    pass_dispatch_pixels(frame, program);
    return true;
}

const struct pass emission_pass = {
    .name = "emission",
    .reads = RESOURCE(DEPTH) | RESOURCE(GBUFFER),
    .writes = RESOURCE(RADIANCE),
    .skip_reason = emission_skip_reason,
    .run = emission_run,
};
