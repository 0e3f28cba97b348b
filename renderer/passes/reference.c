// Uploads the reference's newest image instead of running the real-time passes.
#include "renderer/passes/pass.h"
#include "renderer/frame/view.h"

static const char *reference_skip_reason(const struct frame *frame)
{
    return frame->reference_picture ? NULL : "no reference is shown";
}

static bool reference_run(struct frame *frame, const struct pass *pass, struct error *out_error)
{
    (void)pass;
    (void)out_error;
    gpu_buffer_write(frame->view->radiance, 0,
                     (size_t)frame->width * frame->height * 4 * sizeof(float),
                     frame->reference_picture);
    return true;
}

const struct pass reference_pass = {
    .name = "reference",
    .writes = RESOURCE(RADIANCE),
    .skip_reason = reference_skip_reason,
    .run = reference_run,
    .shows_reference = true,
};
