// Copies the output and then the exposure into the readback ring.
#include "renderer/frame/view.h"
#include "renderer/gi/voxel/volume.h"
#include "renderer/passes/pass.h"

static bool readback_run(struct frame *frame, const struct pass *pass, struct error *out_error)
{
    (void)pass;
    (void)out_error;
    struct view *view = frame->view;
    struct gpu_buffer *pixels = view->ring[view->ring_next].pixels;
    size_t bytes = frame_plan_output_bytes(&frame->inputs);
    gpu_buffer_copy(pixels, 0, view->buffers[RESOURCE_OUTPUT], 0, bytes);
    gpu_buffer_copy(pixels, bytes, view->buffers[RESOURCE_EXPOSURE], 0, VIEW_EXPOSURE_BYTES);
    if (frame->volume)
        gpu_buffer_copy(pixels, bytes + VIEW_EXPOSURE_BYTES, frame->volume->counters,
                        COUNTER_OVERFLOW * 4, VIEW_REPORT_BYTES);
    return true;
}

const struct pass readback_pass = {
    .reads = RESOURCE(OUTPUT) | RESOURCE(EXPOSURE),
    .run = readback_run,
};
