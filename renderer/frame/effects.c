#include "renderer/frame/effects.h"

#include <stdio.h>

#include "renderer/gpu_scene/gpu_scene.h"
#include "renderer/scene/scene.h"

static const struct {
    const char *name;
    const char *define;
} effects[EFFECT_COUNT] = {
    [EFFECT_TEXTURES] = {"textures", "TEXTURES"},
    [EFFECT_ALPHA_MASK] = {"alpha_mask", "ALPHA_MASK"},
    [EFFECT_VERTEX_COLORS] = {"vertex_colors", "VERTEX_COLORS"},
    [EFFECT_SPECULAR] = {"specular", "SPECULAR"},
    [EFFECT_PUNCTUAL_LIGHTS] = {"punctual_lights", "PUNCTUAL_LIGHTS"},
    [EFFECT_AREA_LIGHTS] = {"area_lights", "AREA_LIGHTS"},
    [EFFECT_SHADOWS] = {"shadows", "SHADOWS"},
    [EFFECT_SINGLE_VIEW_SHADOWS] = {"flat_shadows", "SINGLE_VIEW_SHADOWS"},
    [EFFECT_POINT_SHADOWS] = {"cube_shadows", "POINT_SHADOWS"},
    [EFFECT_LIGHT_TILES] = {"light_tiles", "LIGHT_TILES"},
    [EFFECT_BLINN_PHONG] = {"blinn_phong", "BLINN_PHONG"},
    [EFFECT_ENVIRONMENT] = {"environment", "ENVIRONMENT"},
    [EFFECT_TRANSPARENCY] = {"transparency", "TRANSPARENCY"},
    [EFFECT_AUTO_EXPOSURE] = {"auto_exposure", "AUTO_EXPOSURE"},
    [EFFECT_INDIRECT_DIFFUSE] = {"indirect_diffuse", "INDIRECT_DIFFUSE"},
    [EFFECT_MULTI_BOUNCE] = {"bounce", "MULTI_BOUNCE"},
    [EFFECT_INDIRECT_SPECULAR] = {"indirect_specular", "INDIRECT_SPECULAR"},
    [EFFECT_REFRACTION] = {"refraction", "REFRACTION"},
    [EFFECT_SOFT_SHADOWS] = {"soft_shadows", "SOFT_SHADOWS"},
    [EFFECT_AMBIENT_OCCLUSION] = {"ambient_occlusion", "AMBIENT_OCCLUSION"},
    [EFFECT_ENVIRONMENT_LIGHT] = {"environment_light", "ENVIRONMENT_LIGHT"},
    [EFFECT_VOXEL_COLORS] = {"voxel_colors", "VOXEL_COLORS"},
    [EFFECT_CLIP_LEVELS] = {"clip_levels", "CLIP_LEVELS"},
};

const char *effect_name(enum effect effect)
{
    return effects[effect].name;
}

static void decide(struct effect_plan *plan, enum effect effect, bool on, const char *reason)
{
    if (on)
        plan->bits |= EFFECT_BIT(effect);
    snprintf(plan->reasons[effect], sizeof(plan->reasons[effect]), "%s", reason);
}

static bool has_environment(const struct gpu_scene *gpu_scene)
{
    return gpu_scene->scene->environment.type != SCENE_ENVIRONMENT_NONE &&
           gpu_scene->scene->environment.intensity > 0.0f;
}

static void decide_count(struct effect_plan *plan, enum effect effect, uint32_t count,
                         const char *what)
{
    char reason[96];
    if (count > 0)
        snprintf(reason, sizeof(reason), "%u %s%s in the scene", count, what, count > 1 ? "s" : "");
    else
        snprintf(reason, sizeof(reason), "no %s in the scene", what);
    decide(plan, effect, count > 0, reason);
}

// Effects of global illumination. Returns those that the settings allow; the others stay off even
// when all effects are forced.
static uint32_t plan_indirect(struct effect_plan *plan, const struct gpu_scene *gpu_scene,
                              const struct frame_params *params, uint32_t gi_capabilities)
{
    const struct render_settings *settings = &params->settings;
    const struct gpu_scene_counts *counts = &gpu_scene->counts;
    const struct quality_level *level = &quality_levels[params->quality];
    bool rays = settings->gather_mode == GATHER_RAYS ||
                (settings->gather_mode == GATHER_AUTO && level->gather_mode == GATHER_RAYS);
    static const enum effect all[] = {
        EFFECT_INDIRECT_DIFFUSE,  EFFECT_MULTI_BOUNCE, EFFECT_INDIRECT_SPECULAR,
        EFFECT_REFRACTION,        EFFECT_SOFT_SHADOWS, EFFECT_AMBIENT_OCCLUSION,
        EFFECT_ENVIRONMENT_LIGHT, EFFECT_VOXEL_COLORS, EFFECT_CLIP_LEVELS};
    if (!(gi_capabilities & GI_HAS_CONES)) {
        for (size_t i = 0; i < sizeof(all) / sizeof(all[0]); i++)
            decide(plan, all[i], false,
                   gi_capabilities & GI_IS_REFERENCE ? "the method is reference"
                                                     : "no global illumination chosen");
        return 0;
    }
    bool environment = settings->environment_light && has_environment(gpu_scene);
    bool source = counts->lights > 0 || counts->emissive_materials > 0 || environment;
    bool reflected = source && counts->reflective_materials > 0;
    const struct {
        enum effect effect;
        bool allowed, on;
        const char *because, *missing;
    } rules[] = {
        {EFFECT_INDIRECT_DIFFUSE, true, reflected || debug_view_needs_voxels(params->debug_view),
         reflected ? "light meets surfaces that reflect" : "the debug view shows voxels",
         source ? "every surface is black or unlit" : "nothing in the scene gives light"},
        {EFFECT_MULTI_BOUNCE, settings->bounces != 1, reflected,
         "surfaces reflect what they receive", "no surface reflects light"},
        {EFFECT_INDIRECT_SPECULAR, settings->indirect_specular,
         source && counts->specular_materials > 0, "a material reflects like a gloss",
         "no specular material in the scene"},
        {EFFECT_REFRACTION, settings->refraction, counts->transmissive_materials > 0,
         "a material transmits light", "no transmissive material in the scene"},
        {EFFECT_SOFT_SHADOWS,
         settings->soft_shadows && settings->shadows && (level->cone_shadows || rays),
         counts->sized_lights > 0 && counts->lit_materials > 0, "a light has a size",
         counts->lit_materials > 0 ? "no light has a size" : "every surface is unlit"},
        {EFFECT_AMBIENT_OCCLUSION, settings->ambient_occlusion, reflected, "asked for",
         "no indirect light to darken"},
        {EFFECT_ENVIRONMENT_LIGHT, settings->environment_light, environment,
         "the environment lights surfaces", "no environment in the scene"},
    };
    uint32_t allowed = 0;
    for (size_t i = 0; i < sizeof(rules) / sizeof(rules[0]); i++) {
        bool on = rules[i].allowed && rules[i].on;
        allowed |= rules[i].allowed ? EFFECT_BIT(rules[i].effect) : 0;
        decide(plan, rules[i].effect, on,
               !rules[i].allowed ? (rules[i].effect == EFFECT_MULTI_BOUNCE ? "one bounce asked for"
                                                                           : "switched off")
               : on              ? rules[i].because
                                 : rules[i].missing);
    }
    bool colors = counts->textured_materials > 0 || counts->colored_primitives > 0;
    decide(plan, EFFECT_VOXEL_COLORS, colors,
           colors ? "textures or vertex colours in the scene" : "no textures or vertex colours");
    bool clipmap = (gi_capabilities & GI_HAS_CLIP_LEVELS) != 0;
    decide(plan, EFFECT_CLIP_LEVELS, clipmap,
           clipmap ? "the method is clipmap" : "the method is grid");
    return allowed | EFFECT_BIT(EFFECT_VOXEL_COLORS);
}

void effects_plan(struct effect_plan *plan, const struct gpu_scene *gpu_scene,
                  const struct frame_params *params, uint32_t gi_capabilities)
{
    *plan = (struct effect_plan){0};
    const struct render_settings *settings = &params->settings;
    const struct gpu_scene_counts *counts = &gpu_scene->counts;
    decide_count(plan, EFFECT_TEXTURES, counts->textured_materials, "textured material");
    decide_count(plan, EFFECT_ALPHA_MASK, counts->masked_materials, "alpha-masked material");
    decide_count(plan, EFFECT_VERTEX_COLORS, counts->colored_primitives,
                 "primitive with vertex colours");
    decide_count(plan, EFFECT_SPECULAR, counts->specular_materials, "specular material");
    decide_count(plan, EFFECT_PUNCTUAL_LIGHTS, counts->lights, "punctual light");
    decide_count(plan, EFFECT_AREA_LIGHTS, counts->area_lights, "planar emitter");
    decide_count(plan, EFFECT_LIGHT_TILES, counts->ranged_lights, "light of limited range");
    decide_count(plan, EFFECT_TRANSPARENCY, counts->transparent_materials, "transparent material");
    static const enum effect shadow_effects[] = {EFFECT_SHADOWS, EFFECT_SINGLE_VIEW_SHADOWS,
                                                 EFFECT_POINT_SHADOWS};
    const uint32_t shadow_counts[] = {counts->shadow_layers, counts->single_view_shadows,
                                      counts->point_shadows};
    for (int i = 0; i < 3; i++)
        if (settings->shadows)
            decide_count(plan, shadow_effects[i], shadow_counts[i],
                         i == 0   ? "shadow view"
                         : i == 1 ? "spot or sun"
                                  : "all-round lamp");
        else
            decide(plan, shadow_effects[i], false, "switched off");
    if (settings->shading_model == SHADING_MODEL_BLINN_PHONG)
        decide(plan, EFFECT_BLINN_PHONG, true, "chosen for all materials");
    else
        decide_count(plan, EFFECT_BLINN_PHONG, counts->blinn_phong_materials,
                     "Blinn-Phong material");
    bool environment = has_environment(gpu_scene);
    decide(plan, EFFECT_ENVIRONMENT, environment,
           environment ? "the scene has an environment" : "no environment in the scene");
    bool automatic = settings->exposure_mode == EXPOSURE_AUTOMATIC;
    decide(plan, EFFECT_AUTO_EXPOSURE, automatic,
           automatic ? "exposure is automatic" : "exposure is fixed");
    uint32_t chosen = EFFECT_BIT(EFFECT_AUTO_EXPOSURE) | EFFECT_BIT(EFFECT_CLIP_LEVELS) |
                      ((1u << EFFECT_COUNT) - EFFECT_BIT(EFFECT_INDIRECT_DIFFUSE));
    if (!settings->shadows)
        chosen |= EFFECT_BIT(EFFECT_SHADOWS) | EFFECT_BIT(EFFECT_SINGLE_VIEW_SHADOWS) |
                  EFFECT_BIT(EFFECT_POINT_SHADOWS);
    uint32_t allowed = plan_indirect(plan, gpu_scene, params, gi_capabilities) | ~chosen;
    if (settings->force_all_effects)
        for (int i = 0; i < EFFECT_COUNT; i++)
            if ((allowed & EFFECT_BIT(i)) && !(plan->bits & EFFECT_BIT(i)))
                decide(plan, (enum effect)i, true, "forced");
}

void effects_write_defines(uint32_t bits, uint32_t mask, const struct gpu_scene *gpu_scene,
                           char *out_text, size_t out_size)
{
    size_t used = 0;
    out_text[0] = '\0';
    for (int i = 0; i < EFFECT_COUNT; i++) {
        if (!(mask & EFFECT_BIT(i)))
            continue;
        int written;
        if (i == EFFECT_TEXTURES)
            written = snprintf(out_text + used, out_size - used,
                               "COLOR_CLASSES %u\nDATA_CLASSES %u\nTEXTURE_TRANSFORMS %d\n"
                               "SECOND_UV_SET %d\n",
                               gpu_scene->texture_spaces[TEXTURE_SPACE_COLOR].class_count,
                               gpu_scene->texture_spaces[TEXTURE_SPACE_DATA].class_count,
                               gpu_scene->texture_transforms, gpu_scene->second_uv_set);
        else
            written = snprintf(out_text + used, out_size - used, "%s %d\n", effects[i].define,
                               (bits & EFFECT_BIT(i)) != 0);
        used += (size_t)written;
        if (used >= out_size)
            return;
    }
}
