// Debug views: images of intermediate results instead of the shaded scene.
#include <stdio.h>

#include "renderer/gi/voxel/volume.h"
#include "renderer/passes/pass.h"
#include "renderer/frame/view.h"

// Levels beyond are mips, which hold radiance and opacity only.
static bool debug_level_has_cells(const struct frame *frame)
{
    return frame_debug_level(frame) < frame->volume->cell_level_count;
}

bool frame_shows_light(const struct frame *frame)
{
    switch (frame->params->debug_view) {
    case DEBUG_VIEW_FINAL:
    case DEBUG_VIEW_DIRECT:
        return true;
    case DEBUG_VIEW_VOXEL_RADIANCE:
    case DEBUG_VIEW_INDIRECT_DIFFUSE:
    case DEBUG_VIEW_INDIRECT_SPECULAR:
        return frame_has_cones(frame);
    case DEBUG_VIEW_VOXEL_IRRADIANCE:
        return frame_has_cones(frame) && debug_level_has_cells(frame);
    default:
        return false;
    }
}

const char *frame_blank_reason(const struct frame *frame)
{
    if (!debug_view_needs_voxels(frame->params->debug_view) || frame_has_cones(frame))
        return NULL;
    return "plain grey: without global illumination there are no voxels to show";
}

// The pass whose own output is this debug view; NULL for none.
static const struct pass *drawing_pass(const struct frame *frame)
{
    enum debug_view view = frame->params->debug_view;
    return view == DEBUG_VIEW_INDIRECT_DIFFUSE    ? &indirect_diffuse_pass
           : view == DEBUG_VIEW_INDIRECT_SPECULAR ? &indirect_specular_pass
                                                  : NULL;
}

static const char *debug_view_skip_reason(const struct frame *frame)
{
    if (frame_lights_pixels(frame))
        return "no debug view chosen";
    const char *blank = frame_blank_reason(frame);
    if (blank)
        return blank;
    const struct pass *other = drawing_pass(frame);
    return other && !other->skip_reason(frame) ? "the pass of this light draws it" : NULL;
}

// A shader per kind of view, so that none carries another's code.
static const struct gpu_program *program_of_view(const struct frame *frame, const struct pass *pass,
                                                 struct error *out_error)
{
    enum debug_view view = frame->params->debug_view;
    char extra[64];
    switch (view) {
    case DEBUG_VIEW_VOXEL_OPACITY:
    case DEBUG_VIEW_VOXEL_ALBEDO:
    case DEBUG_VIEW_VOXEL_NORMAL:
    case DEBUG_VIEW_VOXEL_RADIANCE:
    case DEBUG_VIEW_VOXEL_IRRADIANCE:
        snprintf(extra, sizeof(extra), "SHOW %d\nCELLS %d\n",
                 (int)view - (int)DEBUG_VIEW_VOXEL_OPACITY, debug_level_has_cells(frame));
        return voxel_program(frame, pass, "debug/voxel_view.comp", extra, out_error);
    case DEBUG_VIEW_AMBIENT_OCCLUSION:
    case DEBUG_VIEW_CACHE_AGE:
        snprintf(extra, sizeof(extra), "AGE %d\nCLIP_LEVELS %d\n", view == DEBUG_VIEW_CACHE_AGE,
                 frame_has(frame, EFFECT_CLIP_LEVELS));
        return voxel_program(frame, pass, "debug/cache_view.comp", extra, out_error);
    case DEBUG_VIEW_TILE_CLASSES:
        snprintf(extra, sizeof(extra), "LAYERS %d\n", !transparency_pass.skip_reason(frame));
        return pass_program(frame, pass, "debug/tile_classes.comp", extra, out_error);
    default:
        return pass_program(frame, pass, "debug/debug_view.comp", "", out_error);
    }
}

static bool debug_view_run(struct frame *frame, const struct pass *pass, struct error *out_error)
{
    const struct gpu_program *program = program_of_view(frame, pass, out_error);
    if (!program)
        return false;
    pass_dispatch_pixels(frame, program);
    return true;
}

const struct pass debug_view_pass = {
    .name = "debug_view",
    .effects_used = EFFECT_BIT(EFFECT_SINGLE_VIEW_SHADOWS) | EFFECT_BIT(EFFECT_POINT_SHADOWS) |
                    EFFECT_BIT(EFFECT_LIGHT_TILES),
    .reads = RESOURCE(LIGHTS) | RESOURCE(SHADOW_MAP) | RESOURCE(IDS) | RESOURCE(DEPTH) |
             RESOURCE(GBUFFER) | RESOURCE(LIGHT_MASKS) | RESOURCE(FRAGMENTS) | RESOURCE(VOXELS) |
             RESOURCE(VOXEL_RADIANCE) | RESOURCE(IRRADIANCE),
    .writes = RESOURCE(RADIANCE),
    .skip_reason = debug_view_skip_reason,
    .run = debug_view_run,
};
