// Exposure, tone curve and transfer function to output pixels.
#include <stdio.h>

#include "renderer/passes/pass.h"
#include "renderer/frame/view.h"
#include "shared/display.h"

_Static_assert((int)FRAME_OUTPUT_YCBCR == OUTPUT_YCBCR && (int)FRAME_OUTPUT_RGBA8 == OUTPUT_RGBA8 &&
                   (int)FRAME_OUTPUT_LINEAR == OUTPUT_LINEAR,
               "shaders know the outputs by these numbers");

static bool tonemap_run(struct frame *frame, const struct pass *pass, struct error *out_error)
{
    char extra[64];
    snprintf(extra, sizeof(extra), "OUTPUT %d\nDISPLAY_READY %d\nBLANK %d\n",
             (int)frame->params->output, !frame_shows_light(frame),
             frame_blank_reason(frame) != NULL);
    const struct gpu_program *program =
        pass_program(frame, pass, "post/tonemap.comp", extra, out_error);
    if (!program)
        return false;
    bool planar = frame->params->output == FRAME_OUTPUT_YCBCR;
    uint32_t step_x = GROUP_EDGE * (planar ? 8 : 1), step_y = GROUP_EDGE * (planar ? 2 : 1);
    gpu_dispatch(frame->gpu, program, (frame->params->width + step_x - 1) / step_x,
                 (frame->params->height + step_y - 1) / step_y, 1);
    return true;
}

const struct pass tonemap_pass = {
    .name = "tonemap",
    .reads = RESOURCE(RADIANCE) | RESOURCE(EXPOSURE),
    .writes = RESOURCE(OUTPUT),
    .run = tonemap_run,
    .shows_reference = true,
};
