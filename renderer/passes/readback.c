// Copies the output and then the exposure into the readback ring.
#include "renderer/gi/voxel/volume.h"
#include "renderer/passes/pass.h"
#include "renderer/frame/view.h"

static bool readback_run(struct frame *frame, const struct pass *pass, struct error *out_error)
{
    (void)pass;
    (void)out_error;
    struct view *view = frame->view;
    size_t offsets[3];
    uint32_t pitches[3];
    size_t bytes = view_output_layout(frame->params, offsets, pitches);
    gpu_buffer_copy(view->ring[view->ring_next].pixels, 0, view->output, 0, bytes);
    gpu_buffer_copy(view->ring[view->ring_next].pixels, bytes, view->exposure, 0,
                    VIEW_EXPOSURE_BYTES);
    if (frame_has_cones(frame))
        gpu_buffer_copy(view->ring[view->ring_next].pixels, bytes + VIEW_EXPOSURE_BYTES,
                        frame->volume->counters, COUNTER_OVERFLOW * 4, VIEW_REPORT_BYTES);
    return true;
}

const struct pass readback_pass = {
    .name = "readback",
    .runs_while_accumulating = true,
    .reads = RESOURCE(OUTPUT) | RESOURCE(EXPOSURE),
    .run = readback_run,
    .shows_reference = true,
};
