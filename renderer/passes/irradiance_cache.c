// Traces the cones of requested voxel faces, within the frame's budget.
#include "renderer/gi/voxel/volume.h"
#include "renderer/passes/pass.h"

#define REQUEST_EDGE 4u // as in shaders/gi/cache_request.comp

enum {
    PROGRAM_REQUEST,
    PROGRAM_SELECT,
    PROGRAM_ARGUMENTS,
    PROGRAM_LOOK_UP,
    PROGRAM_MARCH,
    PROGRAM_SMOOTH,
    PROGRAM_COUNT
};

static bool irradiance_cache_run(struct frame *frame, const struct pass *pass,
                                 struct error *out_error)
{
    struct voxel_volume *volume = frame->volume;
    const struct gpu_program *programs[PROGRAM_COUNT];
    if (!pass_programs(frame, pass, programs, out_error))
        return false;
    struct gpu *gpu = frame->gpu;
    gpu_buffer_fill(volume->counters, COUNTER_CACHE_CLASSES * 4, CACHE_CLASSES * 4, 0);
    pass_dispatch_pixels(frame, programs[PROGRAM_REQUEST], REQUEST_EDGE);
    gpu_barrier(gpu);
    gpu_dispatch_indirect(gpu, programs[PROGRAM_SELECT], volume->counters, COUNTER_LISTS * 4);
    gpu_barrier(gpu);
    gpu_dispatch(gpu, programs[PROGRAM_ARGUMENTS], 1, 1, 1);
    gpu_barrier(gpu);
    gpu_dispatch_indirect(gpu, programs[PROGRAM_LOOK_UP], volume->counters, COUNTER_LOOKUP * 4);
    gpu_barrier(gpu);
    gpu_dispatch_indirect(gpu, programs[PROGRAM_MARCH], volume->counters, COUNTER_MARCH * 4);
    gpu_barrier(gpu);
    if (frame->gi.work.smooth)
        gpu_dispatch_indirect(gpu, programs[PROGRAM_SMOOTH], volume->counters, COUNTER_LISTS * 4);
    return true;
}

#define EFFECTS  (EFFECT_BIT(EFFECT_ENVIRONMENT_LIGHT) | EFFECT_BIT(EFFECT_CLIP_LEVELS))
#define SWITCHES SWITCH_BIT(VOXEL_DIRECTIONS)

const struct pass irradiance_cache_pass = {
    .reads = RESOURCE(GBUFFER) | RESOURCE(VOXELS) | RESOURCE(VOXEL_RADIANCE) | RESOURCE(DEPTH) |
             RESOURCE(ENVIRONMENT) | RESOURCE(SCENE_TABLES),
    .writes = RESOURCE(IRRADIANCE),
    .program_count = PROGRAM_COUNT,
    .programs = {{"gi/cache_request.comp", EFFECTS, SWITCHES, NULL},
                 {"gi/cache_select.comp", EFFECTS, SWITCHES, "STAGE SELECT_FACES\n"},
                 {"gi/cache_select.comp", EFFECTS, SWITCHES, "STAGE SELECT_ARGUMENTS\n"},
                 {"gi/cache_trace.comp", EFFECTS, SWITCHES, "PIXEL_CONES 0\nMARCH 0\n"},
                 {"gi/cache_trace.comp", EFFECTS, SWITCHES, "PIXEL_CONES 0\nMARCH 1\n"},
                 {"gi/cache_smooth.comp", EFFECTS, SWITCHES, NULL}},
    .run = irradiance_cache_run,
};
