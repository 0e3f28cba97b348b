// Automatic exposure from a luminance histogram.
#include "renderer/passes/pass.h"
#include "renderer/frame/view.h"

static const char *exposure_skip_reason(const struct frame *frame)
{
    if (!frame_shows_light(frame))
        return "the debug view is shown as it is";
    if (frame->params->output == FRAME_OUTPUT_LINEAR)
        return "linear output is not exposed";
    return frame->plan.bits & EFFECT_BIT(EFFECT_AUTO_EXPOSURE) ? NULL : "exposure is fixed";
}

static bool exposure_run(struct frame *frame, const struct pass *pass, struct error *out_error)
{
    const struct gpu_program *count =
        pass_program(frame, pass, "post/exposure.comp", "STAGE EXPOSURE_HISTOGRAM\n", out_error);
    const struct gpu_program *reduce =
        count ? pass_program(frame, pass, "post/exposure.comp", "STAGE EXPOSURE_MEAN\n", out_error)
              : NULL;
    if (!reduce)
        return false;
    uint32_t step = 2 * GROUP_EDGE;
    gpu_dispatch(frame->gpu, count, (frame->width + step - 1) / step,
                 (frame->height + step - 1) / step, 1);
    gpu_barrier(frame->gpu);
    gpu_dispatch(frame->gpu, reduce, 1, 1, 1);
    return true;
}

const struct pass exposure_pass = {
    .name = "exposure",
    .reads = RESOURCE(RADIANCE),
    .writes = RESOURCE(EXPOSURE),
    .skip_reason = exposure_skip_reason,
    .run = exposure_run,
    .shows_reference = true,
};
