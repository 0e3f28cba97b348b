// Filters each finer level into the mip levels of a grid, or into the middle of the next clip
// level.
#include "renderer/gi/voxel/volume.h"
#include "renderer/passes/pass.h"

static bool voxel_filter_run(struct frame *frame, const struct pass *pass, struct error *out_error)
{
    struct voxel_volume *volume = frame->volume;
    const struct gpu_program *program = pass_program(frame, pass, 0, out_error);
    if (!program)
        return false;
    for (uint32_t level = 1; level < volume->level_count; level++) {
        voxel_volume_choose_levels(volume, level, level + 1);
        gpu_dispatch_indirect(frame->gpu, program, volume->counters,
                              (COUNTER_LISTS + level * COUNTER_LIST_WORDS) * sizeof(uint32_t));
        gpu_barrier(frame->gpu); // the next level reads what this one wrote
    }
    return true;
}

const struct pass voxel_filter_pass = {
    .reads = RESOURCE(VOXELS) | RESOURCE(VOXEL_RADIANCE),
    .writes = RESOURCE(VOXEL_RADIANCE) | RESOURCE(IRRADIANCE),
    .program_count = 1,
    .programs = {{"voxel/voxel_filter.comp", EFFECT_BIT(EFFECT_CLIP_LEVELS),
                  SWITCH_BIT(VOXEL_DIRECTIONS), NULL}},
    .run = voxel_filter_run,
};
