// Global illumination by voxels: the volumes of all views, and what a frame does with one.
#include "renderer/gi/gi.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "renderer/frame/view.h"
#include "renderer/gi/voxel/cones.h"
#include "renderer/gi/voxel/light_schedule.h"
#include "renderer/gi/voxel/volume.h"

// Target for the stored radiance of the brightest lit surface: far from both ends of a half float's
// range.
#define STORED_PEAK 256.0f
// Keep the scale while radiance is at most so much brighter or darker than when it was chosen.
#define SCALE_GROWTH 8.0f
#define SCALE_DECAY  64.0f
// Reach of ambient occlusion, as a fraction of the scene's diagonal.
#define OCCLUSION_FRACTION 0.05f
// Cones start so many voxels above the surface.
#define START_VOXELS           1.0f
#define START_VOXELS_ISOTROPIC 2.0f

// The volumes of both methods: one scene has few, and a view that changes its method takes the
// place of its former one.
struct kept_volumes {
    uint32_t count;
    struct kept_volume {
        struct voxel_volume *volume;
        const struct view *owner; // whose camera the clipmap follows; NULL for a shared grid
        bool own;                 // used by its owner only
        uint64_t serial;
    } items[VOXEL_MAX_SHARED_VOLUMES + VOXEL_MAX_OWN_VOLUMES];
};

#define KEPT GI_METHOD_CLIPMAP // whichever of the two methods made them

static void release(struct gi *gi)
{
    struct kept_volumes *kept = gi->kept[KEPT];
    for (uint32_t i = 0; kept && i < kept->count; i++)
        voxel_volume_destroy(&kept->items[i].volume);
    free(kept);
    gi->kept[KEPT] = NULL;
}

static void release_unused(struct gi *gi, struct view *const *views, uint32_t view_count)
{
    struct kept_volumes *kept = gi->kept[KEPT];
    for (uint32_t i = 0; kept && i < kept->count;) {
        bool used = false;
        for (uint32_t j = 0; j < view_count; j++)
            used = used || views[j]->gi_serial == kept->items[i].serial;
        if (used) {
            i++;
            continue;
        }
        voxel_volume_destroy(&kept->items[i].volume);
        kept->items[i] = kept->items[--kept->count];
    }
}

static struct voxel_volume *find_by_serial(const struct gi *gi, uint64_t serial)
{
    const struct kept_volumes *kept = gi->kept[KEPT];
    for (uint32_t i = 0; kept && i < kept->count; i++)
        if (kept->items[i].serial == serial)
            return kept->items[i].volume;
    return NULL;
}

static uint32_t edge_of(enum voxel_resolution resolution)
{
    return 32u << resolution;
}

// GPUs afford 128. On CPUs a scene that needs several clip levels converges several times sooner
// with 64, and its extra levels keep voxels as fine near the camera.
static enum voxel_resolution automatic_resolution(const struct frame *frame,
                                                  const struct voxel_volume_params *params)
{
    if (!gpu_get_info(frame->gpu)->software)
        return VOXEL_RESOLUTION_128;
    struct voxel_volume_params wanted = *params;
    wanted.edge = edge_of(frame->plan->quality.voxel_resolution);
    bool deep = wanted.method == GI_METHOD_CLIPMAP &&
                frame->plan->quality.voxel_resolution > VOXEL_RESOLUTION_64 &&
                voxel_volume_choose_clip_levels(&wanted, frame->gpu_scene) > 1;
    return deep ? VOXEL_RESOLUTION_64 : frame->plan->quality.voxel_resolution;
}

// Whether only transparent layers read the cache: with one bounce pixels gather it themselves, and
// no pixel requests faces for the layers.
static bool layers_alone_show_cache(const struct frame *frame)
{
    return frame->params->settings.bounces == 1 && frame_has(frame, EFFECT_TRANSPARENCY);
}

static bool shows_cache(const struct frame *frame)
{
    return frame_plan_shows_cache(&frame->inputs, frame->plan) || layers_alone_show_cache(frame);
}

static struct voxel_volume_params volume_params(const struct frame *frame)
{
    const struct render_settings *settings = &frame->params->settings;
    struct voxel_volume_params params = {
        .method = settings->gi_method,
        .clip_levels = settings->gi_method == GI_METHOD_CLIPMAP ? settings->clip_levels : 0,
        .directions = settings->voxel_directions,
        .cache_cones = cone_set_count(frame->plan->cache_cone_set),
        .colors = frame_has(frame, EFFECT_VOXEL_COLORS),
        .last_bounce = settings->bounces == 0 ? LAST_BOUNCE_ANY
                       : shows_cache(frame)   ? LAST_BOUNCE_CACHED
                                              : LAST_BOUNCE_TRACED,
    };
    enum voxel_resolution resolution = settings->voxel_resolution;
    if (resolution == VOXEL_RESOLUTION_AUTO)
        resolution = automatic_resolution(frame, &params);
    if (params.method == GI_METHOD_CLIPMAP && resolution > VOXEL_RESOLUTION_128)
        resolution = VOXEL_RESOLUTION_128;
    params.edge = edge_of(resolution);
    return params;
}

static bool same_params(const struct voxel_volume_params *a, const struct voxel_volume_params *b)
{
    return a->method == b->method && a->edge == b->edge && a->clip_levels == b->clip_levels &&
           a->directions == b->directions && a->cache_cones == b->cache_cones &&
           a->colors == b->colors &&
           (a->last_bounce == b->last_bounce || a->last_bounce == LAST_BOUNCE_ANY ||
            b->last_bounce == LAST_BOUNCE_ANY);
}

// First volume of the frame's kind (shared, or owned by one view) that the view may draw with. Else
// `out_shared` is another view's clipmap, if any.
static struct kept_volume *find_fitting(struct kept_volumes *kept, const struct frame *frame,
                                        const struct voxel_volume_params *params,
                                        struct kept_volume **out_shared)
{
    bool own = frame->params->own_voxels;
    for (uint32_t i = 0; i < kept->count; i++) {
        struct kept_volume *it = &kept->items[i];
        if (it->own != own || !same_params(&it->volume->params, params))
            continue;
        if (!it->owner || it->owner == frame->view)
            return it;
        if (!own)
            *out_shared = it;
    }
    return NULL;
}

// A volume of the frame's kind that can be replaced: the view's own, or one whose settings are no
// longer in use. NULL for none.
static struct kept_volume *find_replaceable(struct kept_volumes *kept, const struct frame *frame,
                                            const struct voxel_volume_params *params)
{
    bool own = frame->params->own_voxels;
    struct kept_volume *stale = NULL;
    for (uint32_t i = 0; i < kept->count; i++) {
        struct kept_volume *it = &kept->items[i];
        if (it->own != own || same_params(&it->volume->params, params))
            continue;
        if (it->owner == frame->view)
            return it;
        if (!own)
            stale = it; // shared settings have changed; its views have not been drawn since
    }
    return stale;
}

static uint32_t count_volumes(const struct kept_volumes *kept, bool own)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < kept->count; i++)
        count += kept->items[i].own == own;
    return count;
}

// Finds or creates the volume to draw with: the view's own clipmap, or the grid; another view's
// clipmap when there are too many. NULL when memory runs out or too many views own voxels.
static struct kept_volume *find_volume(struct gi *gi, const struct frame *frame,
                                       const struct voxel_volume_params *params)
{
    bool own = frame->params->own_voxels;
    struct kept_volumes *kept = gi->kept[KEPT];
    if (!kept)
        kept = gi->kept[KEPT] = calloc(1, sizeof(*kept));
    if (!kept)
        return NULL;
    struct kept_volume *shared = NULL, *fitting = find_fitting(kept, frame, params, &shared);
    if (fitting)
        return fitting;
    struct kept_volume *slot = NULL;
    if (count_volumes(kept, own) == (own ? VOXEL_MAX_OWN_VOLUMES : VOXEL_MAX_SHARED_VOLUMES)) {
        slot = find_replaceable(kept, frame, params);
        if (shared && (!slot || slot->owner != frame->view))
            return shared;
        if (!slot)
            return NULL;
        voxel_volume_destroy(&slot->volume);
        *slot = kept->items[--kept->count];
    }
    struct voxel_volume *volume = voxel_volume_create(gi->gpu, params);
    if (!volume)
        return NULL;
    bool owned = own || params->method == GI_METHOD_CLIPMAP;
    slot = &kept->items[kept->count++];
    *slot = (struct kept_volume){.volume = volume,
                                 .owner = owned ? frame->view : NULL,
                                 .own = own,
                                 .serial = gi->next_serial++};
    return slot;
}

static float brightest_channel(const float color[3])
{
    return fmaxf(color[0], fmaxf(color[1], color[2]));
}

// Power of two that radiance is divided by, so that it fits half floats. Estimated from the sum of
// all lights' illuminance at 5 % of the scene's diagonal, from emission and from the environment.
// Kept while it still fits, since stored radiance was divided by it.
static float radiance_scale(const struct gpu_scene *gpu_scene, float before)
{
    const struct scene *scene = gpu_scene->scene;
    float brightest = 0.0f;
    float near = 0.05f * gpu_scene->diagonal_m;
    for (uint32_t i = 0; i < scene->light_count; i++) {
        const struct scene_light *light = &scene->lights[i];
        if (light->removed || !light->enabled || !(light->intensity > 0.0f) ||
            !isfinite(light->intensity))
            continue;
        float intensity = light->intensity * brightest_channel(light->color) / (float)GLM_PI;
        bool directional = light->type == SCENE_LIGHT_DIRECTIONAL;
        brightest += directional ? intensity : intensity / (near * near);
    }
    for (uint32_t i = 0; i < scene->material_count; i++)
        brightest = fmaxf(brightest, brightest_channel(scene->materials[i].emissive) *
                                         scene->materials[i].emissive_strength);
    if (scene->environment.type != SCENE_ENVIRONMENT_NONE)
        brightest = fmaxf(brightest, scene->environment.intensity);
    if (!(brightest > 0.0f) || !isfinite(brightest))
        return 1.0f;
    float scale = exp2f(ceilf(log2f(brightest / STORED_PEAK)));
    bool suits = before > 0.0f && scale <= before * SCALE_GROWTH && scale >= before / SCALE_DECAY;
    return suits ? before : scale;
}

static void fill_march(struct voxel_volume *volume, enum cone_set set, float step,
                       struct cone_march *out_march, struct voxel_cone out_cones[VOXEL_MAX_CONES])
{
    struct cone_directions directions;
    cone_directions_init(&directions, set);
    memcpy(out_cones, directions.cones, sizeof(directions.cones));
    bool anisotropic = volume->params.directions == VOXEL_ANISOTROPIC;
    *out_march = (struct cone_march){
        .step_diameters = step,
        .start_voxels = anisotropic ? START_VOXELS : START_VOXELS_ISOTROPIC,
        .cone_count = (float)directions.count,
        .tan_half_angle = directions.tangent,
    };
}

static void fill_cones(const struct frame *frame, struct voxel_volume *volume)
{
    const struct frame_plan *plan = frame->plan;
    struct voxel_block *block = &volume->uniforms;
    fill_march(volume, plan->cache_cone_set, plan->cache_cone_step, &block->cache_march,
               block->cache_cones);
    fill_march(volume, plan->quality.cone_set, plan->quality.cone_step, &block->pixel_march,
               block->pixel_cones);
    block->ao_radius_m = OCCLUSION_FRACTION * frame->gpu_scene->diagonal_m;
}

// Whether the frame has no volume because other views use up all own volumes.
static bool too_many_own(const struct gi *gi, const struct frame *frame)
{
    const struct kept_volumes *kept = gi->kept[KEPT];
    return frame->params->own_voxels && kept && count_volumes(kept, true) == VOXEL_MAX_OWN_VOLUMES;
}

static bool begin(struct gi *gi, struct frame *frame, struct error *out_error)
{
    if (!frame->plan->effects.calls_for_cones)
        return true;
    const struct render_settings *settings = &frame->params->settings;
    struct voxel_volume_params params = volume_params(frame);
    struct kept_volume *found = find_volume(gi, frame, &params);
    struct voxel_volume *volume = found ? found->volume : NULL;
    if (volume && settings->voxelize_every_frame && params.method == GI_METHOD_GRID)
        volume->everything = true;
    if (!volume && too_many_own(gi, frame))
        return error_set(out_error,
                         "%u views have settings of their own; no more of them can have voxels",
                         VOXEL_MAX_OWN_VOLUMES);
    if (!volume || !voxel_volume_update(volume, frame->gpu_scene, frame->camera.eye))
        return error_set(out_error, "voxels of %u^3 do not fit into GPU memory", params.edge);
    frame->volume = volume;
    if (params.last_bounce != LAST_BOUNCE_ANY)
        volume->params.last_bounce = params.last_bounce;
    fill_cones(frame, volume);
    volume->scale = radiance_scale(frame->gpu_scene, volume->scale);
    struct voxel_light_params light = {
        .key = frame->plan->light_key,
        .bounces = settings->bounces,
        .multi_bounce = frame_has(frame, EFFECT_MULTI_BOUNCE),
        .all_faces = frame_has(frame, EFFECT_MULTI_BOUNCE) || layers_alone_show_cache(frame),
        .cache_shown = shows_cache(frame),
        .camera_moved = frame->plan->surfaces_changed,
        .software = gpu_get_info(gi->gpu)->software,
        .levels_per_frame = settings->levels_per_frame,
        .trace_budget = gi->trace_budget,
    };
    frame->gi = (struct gi_state){.serial = found->serial,
                                  .level_count = volume->level_count,
                                  .cell_level_count = volume->cell_level_count};
    voxel_light_begin(volume, &light, &frame->gi.work);
    frame->gi.report_tag = frame->gi.work.trace ? volume->light.generation : 0;
    frame->gi.light_converged = volume->light.converged;
    frame->gi.light_version = volume->light.version;
    return true;
}

static void bind(const struct frame *frame)
{
    const struct accumulation_plan *accumulation = &frame->plan->accumulation;
    if (!frame->volume)
        return;
    struct voxel_block *block = &frame->volume->uniforms;
    block->sample_count = (float)accumulation->samples;
    block->specular_max_roughness = accumulation->specular_max_roughness;
    block->specular_min_reflectance = accumulation->specular_min_reflectance;
    voxel_volume_bind(frame->volume);
}

// Light in voxels first, then the samples of pixels.
static float convergence(const struct frame *frame)
{
    if (!frame->volume)
        return 1.0f;
    float light = voxel_light_convergence(frame->volume);
    const struct accumulation_plan *accumulation = &frame->plan->accumulation;
    if (light < 1.0f || accumulation->target <= 1)
        return light < 1.0f ? 0.9f * light : 1.0f;
    float averaged = (float)accumulation->samples / (float)accumulation->target;
    return fminf(0.9f + 0.1f * averaged, 1.0f);
}

// The tag is the generation of the cache that the frame has traced; 0 for none.
static void collect(struct gi *gi, const struct gi_report *report)
{
    struct voxel_volume *volume = find_by_serial(gi, report->serial);
    if (!volume)
        return;
    struct voxel_light_report light;
    _Static_assert(sizeof(light) == VIEW_REPORT_BYTES, "a frame reads all of it back");
    memcpy(&light, report->bytes, sizeof(light));
    volume->clamped = light.clamped;
    if (report->tag == 0)
        return;
    gpu_timer_poll(report->view->timer);
    voxel_light_collect(volume, report->tag, &light,
                        gpu_timer_get_ms(report->view->timer, PASS_IRRADIANCE_CACHE));
}

static void inspect(const struct gi *gi, uint64_t serial, struct gi_findings *out_findings)
{
    const struct voxel_volume *volume = find_by_serial(gi, serial);
    if (!volume)
        return;
    uint32_t light = 3u << FACE_LIGHT | 3u << FACE_DIRECT | 3u << FACE_SHOWN;
    uint32_t hit_distances = ~((1u << FACE_WORDS) - 1); // of the cones
    *out_findings = (struct gi_findings){
        .values_cut = volume->clamped,
        .resource_count = 2,
        .resources = {{.name = "voxel_radiance",
                       .resource = RESOURCE_VOXEL_RADIANCE,
                       .volume = volume->radiance},
                      {.name = "irradiance_cache",
                       .resource = RESOURCE_IRRADIANCE,
                       .buffer = volume->faces,
                       .floats = {.record_words = FACE_RECORD_WORDS(volume->params.cache_cones),
                                  .low_halves = light | hit_distances,
                                  .high_halves = light}}},
    };
}

#define VOXEL_HOOKS                                                                                \
    .begin = begin, .bind = bind, .convergence = convergence, .collect = collect,                  \
    .inspect = inspect, .release_unused = release_unused, .release = release

const struct gi_method_hooks gi_voxels_clipmap = {
    .capabilities = GI_HAS_CONES | GI_HAS_CLIP_LEVELS,
    VOXEL_HOOKS,
};

const struct gi_method_hooks gi_voxels_grid = {
    .capabilities = GI_HAS_CONES,
    VOXEL_HOOKS,
};
