// Traced visibility of area and sphere lights at pixels. Without this pass, cones or the shadow map
// give it.
#include "renderer/passes/pass.h"

static bool ray_shadows_run(struct frame *frame, const struct pass *pass, struct error *out_error)
{
    const struct gpu_program *program = pass_program(frame, pass, 0, out_error);
    if (!program)
        return false;
    pass_dispatch_pixels(frame, program, frame->plan->gather_step);
    return true;
}

const struct pass ray_shadows_pass = {
    .reads = RESOURCE(BVH) | RESOURCE(SCENE_TABLES) | RESOURCE(GBUFFER) | RESOURCE(DEPTH),
    .writes = RESOURCE(ACCUMULATION),
    .program_count = 1,
    .programs = {{"gi/ray_shadows.comp",
                  (DIRECT_LIGHT_EFFECTS & ~EFFECT_BIT(EFFECT_LIGHT_TILES)) |
                      EFFECT_BIT(EFFECT_ALPHA_MASK),
                  SWITCH_BIT(VOXEL_DIRECTIONS) | SWITCH_BIT(RAY_SHADOWS) |
                      SWITCH_BIT(CONE_SHADOWS) | SWITCH_BIT(GATHER_STEP) |
                      SWITCH_BIT(VISIBILITY_PLANE),
                  NULL}},
    .run = ray_shadows_run,
};
