#include "renderer/frame/frame_plan.h"

#include <math.h>
#include <string.h>

#include "renderer/frame/resource.h"
#include "renderer/hash.h"
#include "shared/display.h"
#include "shared/ray_accumulation.h"
#include "shared/voxel_block.h"
#include "shared/work_groups.h"

// Frames in a row without a new image while the cache converges.
#define MAX_ACCUMULATE_ONLY_FRAMES 7u
// With fewer samples rays are noisier than the cache, which is shown instead.
#define SHOWN_RAYS 16u
// Samples that cone gathering accumulates.
#define CONE_SAMPLES 4u
// Greater than any roughness.
#define ALL_ROUGHNESS 1.01f
// Cones of the cache where the settings leave them open. Independent of quality: views of different
// quality share the cache.
#define CACHE_CONES CONE_SET_16
#define CACHE_STEP  1.0f

uint32_t frame_plan_changes(const struct frame_inputs *in)
{
    const struct frame_history *history = in->history;
    const struct frame_params *now = in->params, *last = &history->params;
    const struct scene_revisions *revisions = in->revisions, *seen = &history->revisions;
    if (!history->drawn || history->scene_number != in->scene_number)
        return INVALIDATES_EVERYTHING;
    uint32_t changes = render_settings_changes(&last->settings, &now->settings);
    if (memcmp(&last->camera, &now->camera, sizeof(now->camera)) != 0 ||
        last->width != now->width || last->height != now->height || last->quality != now->quality)
        changes |= INVALIDATES_FROM_SURFACES;
    if (seen->geometry != revisions->geometry || seen->transforms != revisions->transforms ||
        seen->materials != revisions->materials)
        changes |= INVALIDATES_EVERYTHING;
    if (seen->lights != revisions->lights || seen->environment != revisions->environment)
        changes |= INVALIDATES_FROM_LIGHT;
    if (last->debug_view != now->debug_view || last->debug_level != now->debug_level ||
        last->debug_face != now->debug_face || last->own_voxels != now->own_voxels)
        changes |= INVALIDATES_FROM_SHADING;
    if (last->output != now->output)
        changes |= INVALIDATES_FROM_DISPLAY;
    return changes;
}

bool frame_plan_has_cones(const struct frame_inputs *in)
{
    return (in->gi_capabilities & GI_HAS_CONES) && in->gi;
}

bool frame_plan_lights_pixels(const struct frame_inputs *in)
{
    return in->params->debug_view == DEBUG_VIEW_FINAL ||
           in->params->debug_view == DEBUG_VIEW_DIRECT;
}

uint32_t frame_plan_debug_level(const struct frame_inputs *in)
{
    uint32_t count = frame_plan_has_cones(in) ? in->gi->level_count : 1;
    return in->params->debug_level < count ? in->params->debug_level : count - 1;
}

bool frame_plan_debug_level_has_cells(const struct frame_inputs *in)
{
    return frame_plan_has_cones(in) && frame_plan_debug_level(in) < in->gi->cell_level_count;
}

bool frame_plan_shows_light(const struct frame_inputs *in)
{
    switch (in->params->debug_view) {
    case DEBUG_VIEW_FINAL:
    case DEBUG_VIEW_DIRECT:
        return true;
    case DEBUG_VIEW_VOXEL_RADIANCE:
    case DEBUG_VIEW_INDIRECT_DIFFUSE:
    case DEBUG_VIEW_INDIRECT_SPECULAR:
        return frame_plan_has_cones(in);
    case DEBUG_VIEW_VOXEL_IRRADIANCE:
        return frame_plan_debug_level_has_cells(in);
    default:
        return false;
    }
}

const char *frame_plan_blank_reason(const struct frame_inputs *in)
{
    if (!debug_view_needs_voxels(in->params->debug_view) || frame_plan_has_cones(in))
        return NULL;
    return in->params->settings.gi_method == GI_METHOD_NONE
               ? "plain grey: without global illumination there are no voxels to show"
               : "plain grey: the method has no voxels to show";
}

bool frame_plan_has_cone_shadows(const struct frame_inputs *in, const struct frame_plan *plan)
{
    return frame_plan_has_cones(in) && (plan->effects.bits & EFFECT_BIT(EFFECT_SOFT_SHADOWS)) &&
           plan->quality.cone_shadows;
}

bool frame_plan_shows_cache(const struct frame_inputs *in, const struct frame_plan *plan)
{
    enum debug_view view = in->params->debug_view;
    return plan->quality.gather_mode == GATHER_CACHE || view == DEBUG_VIEW_VOXEL_IRRADIANCE ||
           view == DEBUG_VIEW_AMBIENT_OCCLUSION || view == DEBUG_VIEW_CACHE_AGE;
}

size_t frame_plan_output_layout(const struct frame_params *params, size_t out_offsets[3],
                                uint32_t out_pitches[3])
{
    uint32_t width = params->width, height = params->height;
    for (int i = 0; i < 3; i++) {
        out_offsets[i] = 0;
        out_pitches[i] = 0;
    }
    if (params->output != FRAME_OUTPUT_YCBCR) {
        out_pitches[0] = width * (params->output == FRAME_OUTPUT_RGBA8 ? 4 : 16);
        return (size_t)out_pitches[0] * height;
    }
    // Blocks of 8 x 2 pixels write whole words: pad rows to 8 and their number to 2.
    uint32_t rows = (height + 1) & ~1u;
    out_pitches[0] = (width + 7) & ~7u;
    out_pitches[1] = out_pitches[2] = out_pitches[0] / 2;
    out_offsets[1] = (size_t)out_pitches[0] * rows;
    out_offsets[2] = out_offsets[1] + (size_t)out_pitches[1] * (rows / 2);
    return out_offsets[2] + (size_t)out_pitches[2] * (rows / 2);
}

size_t frame_plan_output_bytes(const struct frame_inputs *in)
{
    size_t offsets[3];
    uint32_t pitches[3];
    return frame_plan_output_layout(in->params, offsets, pitches);
}

size_t frame_plan_accumulation_bytes(const struct frame_inputs *in, const struct frame_plan *plan)
{
    if (!frame_plan_has_cones(in) || plan->quality.gather_mode == GATHER_CACHE)
        return 0;
    uint32_t step = plan->gather_step;
    size_t pixels = (size_t)((plan->width + step - 1) / step) * ((plan->height + step - 1) / step);
    size_t vectors = pixels * plan->accumulation.planes;
    if (plan->accumulation.wants_ray_shadows)
        vectors += (size_t)plan->width * plan->height;
    return vectors * 4 * sizeof(float);
}

// Settings that leave something open take it from the row of the quality table.
static void resolve_quality(struct frame_plan *plan, const struct frame_inputs *in)
{
    const struct render_settings *settings = &in->params->settings;
    struct quality_level *quality = &plan->quality;
    *quality = quality_levels[in->params->quality];
    bool automatic = settings->cone_set == CONE_SET_AUTO;
    plan->cache_cone_set = automatic ? CACHE_CONES : settings->cone_set;
    plan->cache_cone_step = settings->cone_step > 0.0f ? settings->cone_step : CACHE_STEP;
    if (!automatic)
        quality->cone_set = settings->cone_set;
    if (settings->cone_step > 0.0f)
        quality->cone_step = settings->cone_step;
    if (settings->gather_mode != GATHER_AUTO)
        quality->gather_mode = settings->gather_mode;
    plan->gather_step = quality->gather_mode == GATHER_HALF   ? 2
                        : quality->gather_mode == GATHER_RAYS ? quality->ray_step
                                                              : 1;
}

// Excludes quality: views of different quality share a volume and would invalidate it in turn.
static uint64_t find_light_key(const struct frame_plan *plan, const struct frame_inputs *in)
{
    const struct render_settings *settings = &in->params->settings;
    const struct scene_revisions *now = in->revisions;
    const uint64_t words[] = {
        now->geometry,
        now->transforms,
        now->materials,
        now->lights,
        settings->environment_light ? now->environment + 1 : 0,
        (plan->effects.bits & EFFECT_BIT(EFFECT_MULTI_BOUNCE)) != 0,
        render_settings_hash(settings, INVALIDATES_LIGHT),
    };
    uint64_t hash = HASH_START;
    for (size_t i = 0; i < sizeof(words) / sizeof(words[0]); i++)
        hash = hash_word(hash, words[i]);
    return hash;
}

// Rendered size over output size.
static float resolution_scale(const struct frame_plan *plan, const struct frame_inputs *in)
{
    float scale = plan->quality.resolution_scale;
    // The reference chooses its own samples per pixel.
    if (in->gi_capabilities & GI_IS_REFERENCE)
        return 1.0f;
    // While light converges every image is soon replaced: do not supersample a static camera until
    // then. Except without multi-bounce, where pixels request the faces.
    bool settling = frame_plan_has_cones(in) && !in->gi->light_converged &&
                    !plan->surfaces_changed &&
                    (plan->effects.bits & EFFECT_BIT(EFFECT_MULTI_BOUNCE));
    if (settling)
        scale = fminf(scale, 1.0f);
    // GPU memory is planned for VIEW_MAX_WIDTH x VIEW_MAX_HEIGHT: do not supersample beyond it.
    if ((float)in->params->width * scale * (float)in->params->height * scale >
        (float)VIEW_MAX_WIDTH * VIEW_MAX_HEIGHT)
        scale = 1.0f;
    return scale;
}

static void choose_size(struct frame_plan *plan, const struct frame_inputs *in)
{
    float scale = resolution_scale(plan, in);
    plan->width = (uint32_t)((float)in->params->width * scale);
    plan->height = (uint32_t)((float)in->params->height * scale);
    plan->width = plan->width ? plan->width : 1;
    plan->height = plan->height ? plan->height : 1;
    plan->tiles_x = (plan->width + LIGHT_TILE_EDGE - 1) / LIGHT_TILE_EDGE;
    plan->tiles_y = (plan->height + LIGHT_TILE_EDGE - 1) / LIGHT_TILE_EDGE;
    bool resized = plan->width != in->target_width;
    plan->visibility_changed = plan->surfaces_changed || resized;
    plan->unchanged = plan->changes == INVALIDATES_NOTHING && !resized;
}

static uint64_t accumulation_key(const struct frame_plan *plan, const struct frame_inputs *in)
{
    uint32_t step_bits;
    memcpy(&step_bits, &plan->quality.cone_step, sizeof(step_bits));
    const uint64_t words[] = {
        in->gi->light_version,
        plan->light_key,
        in->gi->serial,
        (uint64_t)plan->quality.cone_set,
        step_bits,
        (uint64_t)plan->quality.gather_mode,
        // Planes of effects and views that were off hold nothing.
        plan->effects.bits,
        (uint64_t)in->params->debug_view,
        render_settings_hash(&in->params->settings, INVALIDATES_ACCUMULATION),
    };
    uint64_t hash = HASH_START;
    for (size_t i = 0; i < sizeof(words) / sizeof(words[0]); i++)
        hash = hash_word(hash, words[i]);
    return hash;
}

// Keep the last image until SHOWN_RAYS samples are in. Not with a limited number of bounces: then
// the cache holds one bounce less than is shown and cannot replace the rays.
static bool keeps_last_image(const struct frame_plan *plan, const struct frame_inputs *in,
                             uint32_t samples)
{
    const struct accumulation_plan *accumulation = &plan->accumulation;
    uint32_t enough = accumulation->target < SHOWN_RAYS ? accumulation->target : SHOWN_RAYS;
    return accumulation->gather == GATHER_RAYS && samples < enough &&
           in->params->settings.bounces == 0;
}

static void show_cache(struct frame_plan *plan)
{
    plan->accumulation.gather = GATHER_CACHE;
    plan->accumulation.samples = 0;
    plan->accumulation_after.samples = 0;
}

// While the cache converges, skip shading for up to MAX_ACCUMULATE_ONLY_FRAMES frames.
static void converge_without_shading(struct frame_plan *plan, const struct frame_inputs *in)
{
    const struct frame_history *history = in->history;
    bool shown = plan->unchanged && !in->gi->work.voxelize &&
                 history->shown_light == in->gi->light_version &&
                 history->accumulate_only_count < MAX_ACCUMULATE_ONLY_FRAMES;
    plan->accumulation.only = shown && plan->quality.gather_mode == GATHER_RAYS;
    plan->accumulate_only_count_after =
        plan->accumulation.only ? history->accumulate_only_count + 1 : 0;
    plan->shown_light_after = in->gi->light_version;
}

// Adds one sample, unless all are in. With rays, shows the accumulation whenever the sample count
// has doubled, and with the last sample.
static void accumulate_once(struct frame_plan *plan, const struct frame_inputs *in)
{
    struct accumulation_plan *accumulation = &plan->accumulation;
    uint32_t samples = plan->accumulation_after.samples;
    accumulation->sample = samples < accumulation->target;
    samples += accumulation->sample;
    bool doubled = (samples & (samples - 1)) == 0;
    bool shown =
        samples == accumulation->target || (doubled && !keeps_last_image(plan, in, samples));
    accumulation->only =
        accumulation->gather == GATHER_RAYS && accumulation->sample && plan->unchanged && !shown;
    accumulation->samples = samples;
    plan->accumulation_after.samples = samples;
}

// Pixels show the cache until light has converged, then gather; samples accumulate while nothing
// moves.
static void plan_samples(struct frame_plan *plan, const struct frame_inputs *in)
{
    struct accumulation_plan *accumulation = &plan->accumulation;
    struct accumulation_state *after = &plan->accumulation_after;
    *after = in->history->accumulation;
    plan->shown_light_after = in->history->shown_light;
    plan->accumulate_only_count_after = in->history->accumulate_only_count;
    accumulation->gather = plan->quality.gather_mode;
    if (!frame_plan_has_cones(in) || accumulation->gather == GATHER_CACHE)
        after->samples = 0; // no accumulation: forget its samples
    if (!frame_plan_has_cones(in))
        return;
    accumulation->target = accumulation->gather == GATHER_RAYS    ? plan->quality.ray_pictures
                           : accumulation->gather == GATHER_CACHE ? 1
                                                                  : CONE_SAMPLES;
    accumulation->samples = 1;
    if (accumulation->gather == GATHER_CACHE)
        return;
    uint64_t key = accumulation_key(plan, in);
    if (plan->visibility_changed || in->gi->work.voxelize || key != after->key)
        after->samples = 0;
    after->key = key;
    if (!in->gi->light_converged) {
        show_cache(plan);
        converge_without_shading(plan, in);
    } else if (!plan->unchanged && keeps_last_image(plan, in, after->samples)) {
        show_cache(plan);
    } else {
        accumulate_once(plan, in);
    }
}

static void plan_accumulation(struct frame_plan *plan, const struct frame_inputs *in)
{
    struct accumulation_plan *accumulation = &plan->accumulation;
    uint32_t effects = plan->effects.bits;
    bool rays_wanted = plan->quality.gather_mode == GATHER_RAYS;
    plan_samples(plan, in);
    accumulation->planes = !rays_wanted ? 1
                           : effects & EFFECT_BIT(EFFECT_INDIRECT_SPECULAR)
                               ? PLANES_WITH_SPECULAR
                               : PLANES_WITHOUT_SPECULAR;
    accumulation->wants_ray_shadows = frame_plan_has_cones(in) && rays_wanted &&
                                      (effects & EFFECT_BIT(EFFECT_SOFT_SHADOWS)) &&
                                      in->scene.counts.lights <= FRAME_MAX_RAY_LIGHTS;
    // One ray serves any lobe: where rays gather, every specular lobe is traced.
    bool rays = accumulation->gather == GATHER_RAYS;
    accumulation->ray_shadows = accumulation->wants_ray_shadows && rays;
    accumulation->specular_max_roughness = rays ? ALL_ROUGHNESS : plan->quality.specular_roughness;
    accumulation->specular_min_reflectance = rays ? 0.0f : plan->quality.specular_reflectance;
    plan->needs_bvh = frame_plan_has_cones(in) && rays && accumulation->sample;
}

const char frame_plan_undecided[] = "not decided yet";

#define IN_REFERENCE 1
#define ACCUMULATING 2
#define SKIP_IF(condition, reason)                                                                 \
    if (condition)                                                                                 \
        return reason;
#define PASS(id, name, when, rules)                                                                \
    static const char *name##_reason(const struct frame_inputs *in, const struct frame_plan *plan) \
    {                                                                                              \
        const struct render_settings *settings = &in->params->settings;                            \
        const struct gpu_scene_counts *counts = &in->scene.counts;                                 \
        enum debug_view debug_view = in->params->debug_view;                                       \
        (void)settings, (void)counts, (void)debug_view, (void)plan;                                \
        rules return NULL;                                                                         \
    }
#include "renderer/frame/frame.def"
#undef PASS

static const struct {
    const char *name;
    uint32_t when;
    const char *(*reason)(const struct frame_inputs *in, const struct frame_plan *plan);
} pass_rules[PASS_COUNT] = {
#define PASS(id, name, when, rules) [PASS_##id] = {#name, when, name##_reason},
#include "renderer/frame/frame.def"
#undef PASS
};

const char *pass_name(enum pass_id pass)
{
    return pass_rules[pass].name;
}

_Static_assert(EFFECT_COUNT <= 32 && SWITCH_COUNT <= 32, "programs name them as bits of a mask");

static void plan_passes(struct frame_plan *plan, const struct frame_inputs *in)
{
    static const enum pass_id writers[] = {PASS_ENVIRONMENT, PASS_DIRECT_LIGHT, PASS_EMISSION};
    for (int i = 0; i < PASS_COUNT; i++)
        plan->skip_reasons[i] = frame_plan_undecided;
    for (int i = 0; i < PASS_COUNT; i++)
        plan->skip_reasons[i] = in->reference_shown && !(pass_rules[i].when & IN_REFERENCE)
                                    ? "the reference's picture is shown"
                                : plan->accumulation.only && !(pass_rules[i].when & ACCUMULATING)
                                    ? "light settles; the picture is that of before"
                                    : pass_rules[i].reason(in, plan);
    plan->radiance_writer = PASS_COUNT;
    for (size_t i = sizeof(writers) / sizeof(writers[0]); i-- > 0;)
        if (frame_plan_runs(plan, writers[i]))
            plan->radiance_writer = writers[i];
}

#define SWITCH(id, define, value)                                                                  \
    static uint32_t value_of_##id(const struct frame_inputs *in, const struct frame_plan *plan)    \
    {                                                                                              \
        const struct render_settings *settings = &in->params->settings;                            \
        const struct gpu_scene_counts *counts = &in->scene.counts;                                 \
        enum debug_view debug_view = in->params->debug_view;                                       \
        (void)settings, (void)counts, (void)debug_view, (void)plan;                                \
        return (uint32_t)(value);                                                                  \
    }
#include "renderer/frame/frame.def"
#undef SWITCH

static const struct {
    const char *define;
    uint32_t (*value)(const struct frame_inputs *in, const struct frame_plan *plan);
} switches[SWITCH_COUNT] = {
#define SWITCH(id, define, value) [SWITCH_##id] = {define, value_of_##id},
#include "renderer/frame/frame.def"
#undef SWITCH
};

const char *plan_switch_define(enum plan_switch name)
{
    return switches[name].define;
}

void frame_plan_make(struct frame_plan *plan, const struct frame_inputs *in)
{
    *plan = (struct frame_plan){.changes = frame_plan_changes(in)};
    plan->surfaces_changed =
        in->history->surfaces_stale || (plan->changes & INVALIDATES_SURFACES) != 0;
    resolve_quality(plan, in);
    effects_plan(&plan->effects, in, &plan->quality);
    bool cascades = (plan->effects.bits & EFFECT_BIT(EFFECT_SHADOWS)) && in->scene.cascaded_shadow;
    plan->quality.shadow_cascades = cascades ? plan->quality.shadow_cascades : 0;
    plan->light_key = find_light_key(plan, in);
    choose_size(plan, in);
    plan_accumulation(plan, in);
    plan_passes(plan, in);
    for (int i = 0; i < SWITCH_COUNT; i++)
        plan->switches[i] = switches[i].value(in, plan);
}
