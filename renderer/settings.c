#include "renderer/settings.h"

const char *const gi_method_names[GI_METHOD_COUNT] = {"none", "clipmap", "grid", "reference"};

const char *const voxel_resolution_names[VOXEL_RESOLUTION_COUNT] = {"auto", "64", "128", "256"};

const char *const voxel_directions_names[VOXEL_DIRECTIONS_COUNT] = {"anisotropic", "isotropic"};

const char *const cone_set_names[CONE_SET_COUNT] = {"auto", "5", "6", "9", "16", "32"};

const char *const gather_mode_names[GATHER_COUNT] = {"auto", "cache", "half", "pixel", "rays"};

const char *const levels_per_frame_names[LEVELS_PER_FRAME_COUNT] = {"all", "one"};

const char *const voxel_face_names[VOXEL_FACE_COUNT] = {"+x", "-x", "+y", "-y", "+z", "-z"};

const char *const tonemap_names[TONEMAP_COUNT] = {"hable", "aces", "khronos_neutral", "none"};

const char *const exposure_mode_names[EXPOSURE_MODE_COUNT] = {"automatic", "fixed"};

const char *const shading_model_names[SHADING_MODEL_COUNT] = {"ggx", "blinn_phong"};

const char *const debug_view_names[DEBUG_VIEW_COUNT] = {
    "final",
    "direct",
    "albedo",
    "normal",
    "roughness",
    "metallic",
    "emission",
    "depth",
    "ids",
    "lights_per_tile",
    "shadow_cascades",
    "voxel_opacity",
    "voxel_albedo",
    "voxel_normal",
    "voxel_radiance",
    "voxel_irradiance",
    "indirect_diffuse",
    "indirect_specular",
    "ambient_occlusion",
    "cache_age",
    "tile_classes",
};

const char *const quality_names[QUALITY_COUNT] = {"draft", "interactive", "high", "final"};

const struct quality_level quality_levels[QUALITY_COUNT] = {
    [QUALITY_DRAFT] = {.resolution_scale = 0.5f,
                       .texture_anisotropy = 1.0f,
                       .shadow_taps = 1,
                       .voxel_resolution = VOXEL_RESOLUTION_64,
                       .cone_set = CONE_SET_6,
                       .cone_step = 1.0f,
                       .gather_mode = GATHER_CACHE,
                       .ray_step = 2,
                       .ray_pictures = 16,
                       .specular_roughness = 0.2f,
                       .specular_reflectance = 0.2f},
    [QUALITY_INTERACTIVE] = {.resolution_scale = 1.0f,
                             .texture_anisotropy = 1.0f,
                             .shadow_taps = 4,
                             .shadow_cascades = 1,
                             .voxel_resolution = VOXEL_RESOLUTION_64,
                             .cone_set = CONE_SET_9,
                             .cone_step = 1.0f,
                             .gather_mode = GATHER_RAYS,
                             .ray_step = 1,
                             .ray_pictures = 16,
                             .specular_roughness = 0.35f,
                             .specular_reflectance = 0.2f},
    [QUALITY_HIGH] = {.resolution_scale = 1.0f,
                      .texture_anisotropy = 4.0f,
                      .shadow_taps = 16,
                      .shadow_cascades = 2,
                      .voxel_resolution = VOXEL_RESOLUTION_64,
                      .cone_set = CONE_SET_9,
                      .cone_step = 1.0f,
                      .gather_mode = GATHER_RAYS,
                      .ray_step = 1,
                      .ray_pictures = 64,
                      .cone_shadows = true,
                      .specular_roughness = 0.4f},
    [QUALITY_FINAL] = {.resolution_scale = 2.0f,
                       .texture_anisotropy = 8.0f,
                       .shadow_taps = 32,
                       .shadow_cascades = 3,
                       .voxel_resolution = VOXEL_RESOLUTION_128,
                       .cone_set = CONE_SET_16,
                       .cone_step = 0.5f,
                       .gather_mode = GATHER_RAYS,
                       .ray_step = 2,
                       .ray_pictures = 64,
                       .cone_shadows = true,
                       .specular_roughness = 1.01f},
};

void render_settings_init(struct render_settings *settings)
{
    *settings = (struct render_settings){
        .gi_method = GI_METHOD_CLIPMAP,
        .indirect_intensity = 1.0f,
        .soft_shadows = true,
        .indirect_specular = true,
        .refraction = true,
        .environment_light = true,
        .tonemap = TONEMAP_HABLE,
        .exposure_mode = EXPOSURE_AUTOMATIC,
        .shading_model = SHADING_MODEL_GGX,
        .shadows = true,
    };
}

bool render_settings_equal(const struct render_settings *a, const struct render_settings *b)
{
    return a->gi_method == b->gi_method && a->voxel_resolution == b->voxel_resolution &&
           a->voxel_directions == b->voxel_directions && a->clip_levels == b->clip_levels &&
           a->cone_set == b->cone_set && a->cone_step == b->cone_step &&
           a->gather_mode == b->gather_mode && a->bounces == b->bounces &&
           a->indirect_intensity == b->indirect_intensity &&
           a->ambient_occlusion == b->ambient_occlusion && a->soft_shadows == b->soft_shadows &&
           a->indirect_specular == b->indirect_specular && a->refraction == b->refraction &&
           a->environment_light == b->environment_light &&
           a->voxelize_every_frame == b->voxelize_every_frame &&
           a->levels_per_frame == b->levels_per_frame && a->tonemap == b->tonemap &&
           a->exposure_mode == b->exposure_mode && a->exposure_ev == b->exposure_ev &&
           a->gamma == b->gamma && a->shading_model == b->shading_model &&
           a->shadows == b->shadows && a->force_all_effects == b->force_all_effects;
}

bool debug_view_needs_voxels(enum debug_view view)
{
    return view >= DEBUG_VIEW_VOXEL_OPACITY && view <= DEBUG_VIEW_CACHE_AGE;
}
