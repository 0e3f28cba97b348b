// From radiance to pixels in host memory: exposure, debug views, tone mapping, readback.
#include <stdio.h>

#include "renderer/passes/pass.h"
#include "renderer/view.h"

// G-buffer debug views replace the light passes and are shown as they are.
static bool is_debug_picture(const struct frame *frame)
{
    return frame->params->debug_view != DEBUG_VIEW_FINAL &&
           frame->params->debug_view != DEBUG_VIEW_DIRECT;
}

static const char *exposure_skip_reason(const struct frame *frame)
{
    if (is_debug_picture(frame))
        return "the debug view is shown as it is";
    if (frame->params->output == FRAME_OUTPUT_LINEAR)
        return "linear output is not exposed";
    return frame->plan.bits & EFFECT_BIT(EFFECT_AUTO_EXPOSURE) ? NULL : "exposure is fixed";
}

static bool exposure_run(struct frame *frame, const struct pass *pass, struct error *out_error)
{
    const struct gpu_program *count =
        pass_program(frame, pass, "post/exposure.comp", "STAGE 0\n", out_error);
    const struct gpu_program *reduce =
        count ? pass_program(frame, pass, "post/exposure.comp", "STAGE 1\n", out_error) : NULL;
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
    .use_count = 2,
    .uses = {{RESOURCE_RADIANCE, ACCESS_READ}, {RESOURCE_EXPOSURE, ACCESS_WRITE}},
    .skip_reason = exposure_skip_reason,
    .run = exposure_run,
};

static const char *debug_view_skip_reason(const struct frame *frame)
{
    return is_debug_picture(frame) ? NULL : "no debug view chosen";
}

static bool debug_view_run(struct frame *frame, const struct pass *pass, struct error *out_error)
{
    const struct gpu_program *program =
        pass_program(frame, pass, "debug/debug_view.comp", "", out_error);
    if (!program)
        return false;
    pass_dispatch_pixels(frame, program);
    return true;
}

const struct pass debug_view_pass = {
    .name = "debug_view",
    .effects_used = EFFECT_BIT(EFFECT_FLAT_SHADOWS) | EFFECT_BIT(EFFECT_CUBE_SHADOWS) |
                    EFFECT_BIT(EFFECT_LIGHT_TILES),
    .use_count = 5,
    .uses = {{RESOURCE_IDS, ACCESS_READ},
             {RESOURCE_DEPTH, ACCESS_READ},
             {RESOURCE_GBUFFER, ACCESS_READ},
             {RESOURCE_LIGHT_MASKS, ACCESS_READ},
             {RESOURCE_RADIANCE, ACCESS_WRITE}},
    .skip_reason = debug_view_skip_reason,
    .run = debug_view_run,
};

static bool tonemap_run(struct frame *frame, const struct pass *pass, struct error *out_error)
{
    char extra[64];
    snprintf(extra, sizeof(extra), "OUTPUT %d\nDISPLAY_READY %d\n", (int)frame->params->output,
             is_debug_picture(frame));
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
    .use_count = 3,
    .uses = {{RESOURCE_RADIANCE, ACCESS_READ},
             {RESOURCE_EXPOSURE, ACCESS_READ},
             {RESOURCE_OUTPUT, ACCESS_WRITE}},
    .run = tonemap_run,
};

static bool readback_run(struct frame *frame, const struct pass *pass, struct error *out_error)
{
    (void)pass;
    (void)out_error;
    struct view *view = frame->view;
    size_t offsets[3];
    uint32_t pitches[3];
    size_t bytes = view_output_layout(frame->params, offsets, pitches);
    gpu_buffer_copy(view->ring[view->ring_next].pixels, 0, view->output, 0, bytes);
    return true;
}

const struct pass readback_pass = {
    .name = "readback",
    .use_count = 1,
    .uses = {{RESOURCE_OUTPUT, ACCESS_READ}},
    .run = readback_run,
};
