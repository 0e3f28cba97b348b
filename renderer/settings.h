// What a frame looks like beside the scene itself: plain data, set by whoever asks for the frame.
#ifndef VOXCAST_RENDERER_SETTINGS_H
#define VOXCAST_RENDERER_SETTINGS_H

#include <stdbool.h>
#include <stdint.h>

#define VIEW_MAX_WIDTH  3840u
#define VIEW_MAX_HEIGHT 2160u
#define VIEW_MIN_EDGE   1u

enum gi_method { GI_METHOD_NONE, GI_METHOD_COUNT };

enum tonemap { TONEMAP_HABLE, TONEMAP_ACES, TONEMAP_KHRONOS_NEUTRAL, TONEMAP_NONE, TONEMAP_COUNT };

enum exposure_mode { EXPOSURE_AUTOMATIC, EXPOSURE_FIXED, EXPOSURE_MODE_COUNT };

enum shading_model { SHADING_MODEL_GGX, SHADING_MODEL_BLINN_PHONG, SHADING_MODEL_COUNT };

enum debug_view {
    DEBUG_VIEW_FINAL,
    DEBUG_VIEW_DIRECT,
    DEBUG_VIEW_ALBEDO,
    DEBUG_VIEW_NORMAL,
    DEBUG_VIEW_ROUGHNESS,
    DEBUG_VIEW_METALLIC,
    DEBUG_VIEW_EMISSION,
    DEBUG_VIEW_DEPTH,
    DEBUG_VIEW_IDS,
    DEBUG_VIEW_LIGHTS_PER_TILE,
    DEBUG_VIEW_SHADOW_CASCADES,
    DEBUG_VIEW_COUNT
};

enum quality { QUALITY_DRAFT, QUALITY_INTERACTIVE, QUALITY_HIGH, QUALITY_FINAL, QUALITY_COUNT };

// Names as the protocol and the command line spell them; indexed by the enums above.
extern const char *const gi_method_names[GI_METHOD_COUNT];
extern const char *const tonemap_names[TONEMAP_COUNT];
extern const char *const exposure_mode_names[EXPOSURE_MODE_COUNT];
extern const char *const shading_model_names[SHADING_MODEL_COUNT];
extern const char *const debug_view_names[DEBUG_VIEW_COUNT];
extern const char *const quality_names[QUALITY_COUNT];

// Shared by all views of a scene.
struct render_settings {
    enum gi_method gi_method;
    enum tonemap tonemap;
    enum exposure_mode exposure_mode;
    float exposure_ev; // added stops; in fixed mode radiance is scaled by 2^exposure_ev
    float gamma;       // 0 means the sRGB curve; else a plain power
    enum shading_model shading_model; // for materials that do not say Blinn-Phong themselves
    bool shadows;
    bool force_all_effects; // run every effect, needed or not: for proving that planning is exact
};

// One row of the quality table: what costs time and may be traded for it.
struct quality_level {
    float resolution_scale;   // rendered size over shown size; 2 averages four samples a pixel
    float texture_anisotropy; // 1 is plain trilinear
    uint32_t shadow_taps;     // PCF taps per light and pixel
    uint32_t shadow_cascades; // of the sun, around the camera, beside the map of the whole scene
};

extern const struct quality_level quality_levels[QUALITY_COUNT];

struct view_camera {
    float eye[3];    // world, metres
    float target[3]; // world
    float up[3];
    float fov_y_rad;
};

void render_settings_init(struct render_settings *settings);

#endif
