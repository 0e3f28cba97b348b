// Filters each finer level into the mip levels of a grid, or into the middle of the next clip
// level.
#include "renderer/gi/voxel/volume.h"
#include "renderer/passes/pass.h"

static const char *voxel_filter_skip_reason(const struct frame *frame)
{
    if (!frame_has_cones(frame))
        return "no effect needs voxels";
    if (frame->volume->level_count == 1)
        return "one level only";
    return frame->light_work.relight ? NULL : "light in voxels unchanged";
}

static bool voxel_filter_run(struct frame *frame, const struct pass *pass, struct error *out_error)
{
    struct voxel_volume *volume = frame->volume;
    const struct gpu_program *program =
        voxel_program(frame, pass, "voxel/voxel_filter.comp", "", out_error);
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
    .name = "voxel_filter",
    .effects_used = EFFECT_BIT(EFFECT_CLIP_LEVELS),
    .runs_while_accumulating = true,
    .reads = RESOURCE(VOXELS) | RESOURCE(VOXEL_RADIANCE),
    .writes = RESOURCE(VOXEL_RADIANCE) | RESOURCE(IRRADIANCE),
    .skip_reason = voxel_filter_skip_reason,
    .run = voxel_filter_run,
};
