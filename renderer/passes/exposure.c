// Automatic exposure from a luminance histogram.
#include "renderer/passes/pass.h"
#include "shared/display.h"
#include "shared/work_groups.h"

_Static_assert(HISTOGRAM_BINS <= PIXEL_GROUP_WIDTH * PIXEL_GROUP_HEIGHT,
               "an invocation of each group keeps a bin");

enum { PROGRAM_HISTOGRAM, PROGRAM_MEAN, PROGRAM_COUNT };

static bool exposure_run(struct frame *frame, const struct pass *pass, struct error *out_error)
{
    const struct gpu_program *programs[PROGRAM_COUNT];
    if (!pass_programs(frame, pass, programs, out_error))
        return false;
    pass_dispatch_pixels(frame, programs[PROGRAM_HISTOGRAM], 2);
    gpu_barrier(frame->gpu);
    gpu_dispatch(frame->gpu, programs[PROGRAM_MEAN], 1, 1, 1);
    return true;
}

const struct pass exposure_pass = {
    .reads = RESOURCE(RADIANCE),
    .writes = RESOURCE(EXPOSURE),
    .program_count = PROGRAM_COUNT,
    .programs = {{"post/exposure.comp", 0, 0, "STAGE EXPOSURE_HISTOGRAM\n"},
                 {"post/exposure.comp", 0, 0, "STAGE EXPOSURE_MEAN\n"}},
    .run = exposure_run,
};
