// Exposure, tone curve and transfer function to output pixels.
#include "renderer/passes/pass.h"
#include "shared/display.h"
#include "shared/work_groups.h"

_Static_assert((int)FRAME_OUTPUT_YCBCR == OUTPUT_YCBCR && (int)FRAME_OUTPUT_RGBA8 == OUTPUT_RGBA8 &&
                   (int)FRAME_OUTPUT_LINEAR == OUTPUT_LINEAR,
               "shaders know the outputs by these numbers");

static bool tonemap_run(struct frame *frame, const struct pass *pass, struct error *out_error)
{
    const struct gpu_program *program = pass_program(frame, pass, 0, out_error);
    if (!program)
        return false;
    bool planar = frame->params->output == FRAME_OUTPUT_YCBCR;
    uint32_t step_x = PIXEL_GROUP_WIDTH * (planar ? 8 : 1);
    uint32_t step_y = PIXEL_GROUP_HEIGHT * (planar ? 2 : 1);
    gpu_dispatch(frame->gpu, program, (frame->params->width + step_x - 1) / step_x,
                 (frame->params->height + step_y - 1) / step_y, 1);
    return true;
}

const struct pass tonemap_pass = {
    .reads = RESOURCE(RADIANCE) | RESOURCE(EXPOSURE),
    .writes = RESOURCE(OUTPUT),
    .program_count = 1,
    .programs = {{"post/tonemap.comp", 0,
                  SWITCH_BIT(OUTPUT) | SWITCH_BIT(DISPLAY_READY) | SWITCH_BIT(BLANK) |
                      SWITCH_BIT(SCALED) | SWITCH_BIT(TONE_CURVE) | SWITCH_BIT(POWER_TRANSFER),
                  NULL}},
    .run = tonemap_run,
};
