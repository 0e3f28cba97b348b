// Uploads the reference's newest image instead of running the real-time passes.
#include "renderer/frame/view.h"
#include "renderer/passes/pass.h"

static bool reference_run(struct frame *frame, const struct pass *pass, struct error *out_error)
{
    (void)pass;
    (void)out_error;
    gpu_buffer_write(frame->view->buffers[RESOURCE_RADIANCE], 0,
                     (size_t)frame->plan->width * frame->plan->height * 4 * sizeof(float),
                     frame->reference_picture);
    return true;
}

const struct pass reference_pass = {
    .writes = RESOURCE(RADIANCE),
    .run = reference_run,
};
