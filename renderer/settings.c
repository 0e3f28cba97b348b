#include "renderer/settings.h"

const char *const gi_method_names[GI_METHOD_COUNT] = {"none"};

const char *const tonemap_names[TONEMAP_COUNT] = {"hable", "aces", "khronos_neutral", "none"};

const char *const exposure_mode_names[EXPOSURE_MODE_COUNT] = {"automatic", "fixed"};

const char *const shading_model_names[SHADING_MODEL_COUNT] = {"ggx", "blinn_phong"};

const char *const debug_view_names[DEBUG_VIEW_COUNT] = {
    "final",    "direct", "albedo", "normal",          "roughness",       "metallic",
    "emission", "depth",  "ids",    "lights_per_tile", "shadow_cascades",
};

const char *const quality_names[QUALITY_COUNT] = {"draft", "interactive", "high", "final"};

const struct quality_level quality_levels[QUALITY_COUNT] = {
    [QUALITY_DRAFT] = {.resolution_scale = 0.5f, .texture_anisotropy = 1.0f, .shadow_taps = 1},
    [QUALITY_INTERACTIVE] = {.resolution_scale = 1.0f,
                             .texture_anisotropy = 1.0f,
                             .shadow_taps = 4,
                             .shadow_cascades = 1},
    [QUALITY_HIGH] = {.resolution_scale = 1.0f,
                      .texture_anisotropy = 4.0f,
                      .shadow_taps = 16,
                      .shadow_cascades = 2},
    [QUALITY_FINAL] = {.resolution_scale = 2.0f,
                       .texture_anisotropy = 8.0f,
                       .shadow_taps = 32,
                       .shadow_cascades = 3},
};

void render_settings_init(struct render_settings *settings)
{
    *settings = (struct render_settings){
        .gi_method = GI_METHOD_NONE,
        .tonemap = TONEMAP_HABLE,
        .exposure_mode = EXPOSURE_AUTOMATIC,
        .shading_model = SHADING_MODEL_GGX,
        .shadows = true,
    };
}
