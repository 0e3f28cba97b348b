// Turns visibility ids into the G-buffer.
#include "renderer/passes/pass.h"

static const char *gbuffer_skip_reason(const struct frame *frame)
{
    return frame->visibility_changed ? NULL : "camera and geometry unchanged";
}

static bool gbuffer_run(struct frame *frame, const struct pass *pass, struct error *out_error)
{
    const struct gpu_program *program =
        pass_program(frame, pass, "visibility/gbuffer.comp", "", out_error);
    if (!program)
        return false;
    pass_dispatch_pixels(frame, program);
    return true;
}

const struct pass gbuffer_pass = {
    .name = "gbuffer",
    .effects_used = SURFACE_EFFECTS,
    .reads = RESOURCE(IDS) | RESOURCE(DEPTH) | RESOURCE(GEOMETRY) | RESOURCE(MATERIALS),
    .writes = RESOURCE(GBUFFER),
    .skip_reason = gbuffer_skip_reason,
    .run = gbuffer_run,
};
