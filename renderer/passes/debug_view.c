// Debug views: images of intermediate results instead of the shaded scene.
#include "renderer/passes/pass.h"

// A shader per kind of view, so that none carries another's code.
enum { PROGRAM_SURFACES, PROGRAM_VOXELS, PROGRAM_CACHE, PROGRAM_TILE_CLASSES, PROGRAM_COUNT };

static uint32_t program_of_view(enum debug_view view)
{
    switch (view) {
    case DEBUG_VIEW_VOXEL_OPACITY:
    case DEBUG_VIEW_VOXEL_ALBEDO:
    case DEBUG_VIEW_VOXEL_NORMAL:
    case DEBUG_VIEW_VOXEL_RADIANCE:
    case DEBUG_VIEW_VOXEL_IRRADIANCE:
        return PROGRAM_VOXELS;
    case DEBUG_VIEW_AMBIENT_OCCLUSION:
    case DEBUG_VIEW_CACHE_AGE:
        return PROGRAM_CACHE;
    case DEBUG_VIEW_TILE_CLASSES:
        return PROGRAM_TILE_CLASSES;
    default:
        return PROGRAM_SURFACES;
    }
}

static bool debug_view_run(struct frame *frame, const struct pass *pass, struct error *out_error)
{
    uint32_t number = program_of_view(frame->params->debug_view);
    if (number != PROGRAM_TILE_CLASSES)
        return pass_run_pixels(frame, pass, number, out_error);
    const struct gpu_program *program = pass_program(frame, pass, number, out_error);
    if (!program)
        return false;
    pass_dispatch_tiles(frame, program, 1);
    return true;
}

#define EFFECTS                                                                                    \
    (EFFECT_BIT(EFFECT_SINGLE_VIEW_SHADOWS) | EFFECT_BIT(EFFECT_POINT_SHADOWS) |                   \
     EFFECT_BIT(EFFECT_LIGHT_TILES))

const struct pass debug_view_pass = {
    .reads = RESOURCE(SCENE_TABLES) | RESOURCE(SHADOW_MAP) | RESOURCE(IDS) | RESOURCE(DEPTH) |
             RESOURCE(GBUFFER) | RESOURCE(LIGHT_MASKS) | RESOURCE(FRAGMENTS) | RESOURCE(VOXELS) |
             RESOURCE(VOXEL_RADIANCE) | RESOURCE(IRRADIANCE),
    .writes = RESOURCE(RADIANCE),
    .program_count = PROGRAM_COUNT,
    .programs = {{"debug/debug_view.comp", EFFECTS, SWITCH_BIT(POWER_TRANSFER), NULL},
                 {"debug/voxel_view.comp", EFFECTS,
                  SWITCH_BIT(VOXEL_DIRECTIONS) | SWITCH_BIT(SHOW) | SWITCH_BIT(CELLS) |
                      SWITCH_BIT(POWER_TRANSFER),
                  NULL},
                 {"debug/cache_view.comp", EFFECTS | EFFECT_BIT(EFFECT_CLIP_LEVELS),
                  SWITCH_BIT(VOXEL_DIRECTIONS) | SWITCH_BIT(AGE), NULL},
                 {"debug/tile_classes.comp", EFFECTS, SWITCH_BIT(LAYERS), NULL}},
    .run = debug_view_run,
};
