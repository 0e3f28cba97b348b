#include "support_frame.h"

#include <string.h>

void at_rest(struct situation *it)
{
    memset(it, 0, sizeof(*it));
    it->params.width = WIDTH;
    it->params.height = HEIGHT;
    it->params.quality = QUALITY_HIGH;
    it->params.output = FRAME_OUTPUT_YCBCR;
    render_settings_init(&it->params.settings);
    it->revisions = (struct scene_revisions){1, 1, 1, 1, 1};
    it->history = (struct frame_history){
        .drawn = true, .params = it->params, .revisions = it->revisions, .scene_number = 1};
    it->gi = (struct gi_state){.serial = 1,
                               .level_count = 3,
                               .cell_level_count = 3,
                               .light_converged = true,
                               .light_version = 1};
    it->inputs = (struct frame_inputs){
        .params = &it->params,
        .revisions = &it->revisions,
        .scene_number = 1,
        .history = &it->history,
        .target_width = WIDTH,
        .scene = {.counts =
                      {.instances = 1, .lights = 1, .lit_materials = 1, .reflective_materials = 1}},
        .gi_capabilities = GI_HAS_CONES | GI_HAS_CLIP_LEVELS,
        .gi = &it->gi,
    };
}

void camera_moves(struct situation *it)
{
    it->params.camera.eye[1] = 1.0f;
}

void size_changes(struct situation *it)
{
    it->params.height = 2 * HEIGHT;
}

void quality_changes(struct situation *it)
{
    it->params.quality = QUALITY_FINAL;
}

void geometry_changes(struct situation *it)
{
    it->revisions.geometry++;
}

void transform_changes(struct situation *it)
{
    it->revisions.transforms++;
}

void material_changes(struct situation *it)
{
    it->revisions.materials++;
}

void light_changes(struct situation *it)
{
    it->revisions.lights++;
}

void environment_changes(struct situation *it)
{
    it->revisions.environment++;
}

void debug_view_changes(struct situation *it)
{
    it->params.debug_view = DEBUG_VIEW_NORMAL;
}

void tonemap_changes(struct situation *it)
{
    it->params.settings.tonemap = TONEMAP_NONE;
}

void bounces_change(struct situation *it)
{
    it->params.settings.bounces = 3;
}

// The history's accumulation is of the same frame.
static void keep_samples(struct situation *it, uint32_t samples)
{
    struct frame_plan plan;
    frame_plan_make(&plan, &it->inputs);
    it->history.accumulation = plan.accumulation_after;
    it->history.accumulation.samples = samples;
    it->history.shown_light = it->gi.light_version;
}

void samples_are_few(struct situation *it)
{
    keep_samples(it, 4);
}

void all_samples_are_in(struct situation *it)
{
    keep_samples(it, quality_levels[QUALITY_HIGH].ray_pictures);
}
