// Injects light into occupied voxels: direct light, emission, and the cache's bounce.
#include "renderer/gi/voxel/volume.h"
#include "renderer/passes/pass.h"

enum { PROGRAM_DIRECT, PROGRAM_BOUNCE, PROGRAM_COUNT };

static bool voxel_relight_run(struct frame *frame, const struct pass *pass, struct error *out_error)
{
    struct voxel_volume *volume = frame->volume;
    const struct voxel_light_work *work = &frame->gi.work;
    const struct gpu_program *program =
        pass_program(frame, pass, work->direct ? PROGRAM_DIRECT : PROGRAM_BOUNCE, out_error);
    if (!program)
        return false;
    voxel_volume_choose_levels(volume, work->relight_first, work->relight_end);
    gpu_dispatch_indirect(frame->gpu, program, volume->counters, COUNTER_LISTS * 4);
    return true;
}

#define EFFECTS                                                                                    \
    (EFFECT_BIT(EFFECT_SHADOWS) | EFFECT_BIT(EFFECT_SINGLE_VIEW_SHADOWS) |                         \
     EFFECT_BIT(EFFECT_POINT_SHADOWS) | EFFECT_BIT(EFFECT_PUNCTUAL_LIGHTS) |                       \
     EFFECT_BIT(EFFECT_AREA_LIGHTS) | EFFECT_BIT(EFFECT_INDIRECT_DIFFUSE) |                        \
     EFFECT_BIT(EFFECT_VOXEL_COLORS))
#define SWITCHES (SWITCH_BIT(VOXEL_DIRECTIONS) | SWITCH_BIT(INJECTED_BOUNCE) | SWITCH_BIT(FRESH))
#define FIXED    "LIGHT_TILES 0\nSPECULAR 0\nBLINN_PHONG 0\nTAPS 4\n"

const struct pass voxel_relight_pass = {
    // Also reads the irradiance cache, as an earlier frame left it.
    .reads = RESOURCE(VOXELS) | RESOURCE(SHADOW_MAP) | RESOURCE(SCENE_TABLES) |
             RESOURCE(SCENE_TABLES) | RESOURCE(TEXTURES),
    .writes = RESOURCE(VOXEL_RADIANCE) | RESOURCE(IRRADIANCE),
    .program_count = PROGRAM_COUNT,
    .programs = {{"voxel/voxel_relight.comp", EFFECTS, SWITCHES, FIXED},
                 {"voxel/voxel_inject_bounce.comp", EFFECTS, SWITCHES, FIXED}},
    .run = voxel_relight_run,
};
