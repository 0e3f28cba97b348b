// Direct light from punctual and area lights.
#include "renderer/passes/pass.h"

static bool direct_light_run(struct frame *frame, const struct pass *pass, struct error *out_error)
{
    return pass_run_pixels(frame, pass, 0, out_error);
}

const struct pass direct_light_pass = {
    .reads = RESOURCE(GBUFFER) | RESOURCE(DEPTH) | RESOURCE(SHADOW_MAP) | RESOURCE(VOXEL_RADIANCE) |
             RESOURCE(LIGHT_MASKS) | RESOURCE(RADIANCE) | RESOURCE(ACCUMULATION) |
             RESOURCE(SCENE_TABLES) | RESOURCE(VOXELS) | RESOURCE(IRRADIANCE) |
             RESOURCE(ENVIRONMENT),
    .writes = RESOURCE(RADIANCE),
    .program_count = 1,
    .programs = {{"light/direct_light.comp", DIRECT_LIGHT_EFFECTS,
                  SWITCH_BIT(VOXEL_DIRECTIONS) | SWITCH_BIT(ADDED_TO) | SWITCH_BIT(RAY_SHADOWS) |
                      SWITCH_BIT(CONE_SHADOWS) | SWITCH_BIT(GATHER_STEP) |
                      SWITCH_BIT(VISIBILITY_PLANE),
                  NULL}},
    .run = direct_light_run,
};
