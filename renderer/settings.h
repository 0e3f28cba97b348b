// What a frame shows besides the scene: plain data, set by the caller of the frame.
#ifndef VOXCAST_RENDERER_SETTINGS_H
#define VOXCAST_RENDERER_SETTINGS_H

#include <stdbool.h>
#include <stdint.h>

#include "renderer/parameter_types.h"

#define VIEW_MAX_WIDTH  4096u
#define VIEW_MAX_HEIGHT 2160u
#define VIEW_MIN_EDGE   1u

#define RENDERER_MAX_VIEWS 64u

#define CLIP_MAX_LEVELS 6u
#define CONE_STEP_MIN   0.25f
#define CONE_STEP_MAX   2.0f

// Shared by all views of a scene; the fields are the rows of protocol/parameters/settings.def.
struct render_settings {
#define PARAMETER(record, name, type, ...) PARAMETER_FIELD(type, name)
#include "protocol/parameters/settings.def"
#undef PARAMETER
};

// One row of the quality table: what costs time and may be traded for it.
struct quality_level {
    float resolution_scale;   // rendered size over output size; 2 averages four samples per pixel
    float texture_anisotropy; // 1 is plain trilinear
    uint32_t shadow_taps;     // PCF taps per light and pixel
    uint32_t
        shadow_cascades; // of the sun around the camera, in addition to the map of the whole scene
    enum voxel_resolution voxel_resolution; // on a GPU at least 128
    enum cone_set cone_set;
    float cone_step;
    enum gather_mode gather_mode;
    uint32_t ray_step;          // final gather by rays: every how many-th rendered pixel traces,
    uint32_t ray_pictures;      // and how many samples each accumulates
    bool cone_shadows;          // soft shadows by cones where rays do not trace them
    float specular_roughness;   // rougher surfaces take specular light from the cached irradiance,
    float specular_reflectance; // and so do those with a lower reflectance at normal incidence
    bool shared_specular_cones; // one for four similar pixels
};

extern const struct quality_level quality_levels[QUALITY_COUNT];

// World, metres; the fields are the rows of protocol/parameters/camera.def.
struct view_camera {
#define PARAMETER(record, name, type, ...) PARAMETER_FIELD(type, name)
#include "protocol/parameters/camera.def"
#undef PARAMETER
};

void render_settings_init(struct render_settings *settings);

// What to redraw to go from `a` to `b`: the invalidation bits of all settings that differ; 0 if
// equal.
uint32_t render_settings_changes(const struct render_settings *a, const struct render_settings *b);

// Hash of the settings that invalidate any of `parts`.
uint64_t render_settings_hash(const struct render_settings *settings, uint32_t parts);

// Copies from `from` the settings whose invalidation bits are exactly `parts`.
void render_settings_take(struct render_settings *settings, const struct render_settings *from,
                          uint32_t parts);

// Whether the view shows something that only global illumination computes.
bool debug_view_needs_voxels(enum debug_view view);

#endif
