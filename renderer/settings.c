#include "renderer/settings.h"

#include <stddef.h>

#include "renderer/hash.h"

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
                       .specular_reflectance = 0.2f,
                       .shared_specular_cones = true},
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
                             .specular_reflectance = 0.2f,
                             .shared_specular_cones = true},
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
#define PARAMETER(record, name, type, range, unit, initial, ...) .name = initial,
#include "protocol/parameters/settings.def"
#undef PARAMETER
    };
}

uint32_t render_settings_changes(const struct render_settings *a, const struct render_settings *b)
{
    uint32_t changes = INVALIDATES_NOTHING;
#define PARAMETER(record, name, type, range, unit, initial, handling, redraw, ...)                 \
    if (a->name != b->name)                                                                        \
        changes |= INVALIDATES_##redraw;
#include "protocol/parameters/settings.def"
#undef PARAMETER
    return changes;
}

uint64_t render_settings_hash(const struct render_settings *settings, uint32_t parts)
{
    uint64_t hash = HASH_START;
#define PARAMETER(record, name, type, range, unit, initial, handling, redraw, ...)                 \
    if (parts & INVALIDATES_##redraw)                                                              \
        hash = hash_bytes(hash, &settings->name, sizeof(settings->name));
#include "protocol/parameters/settings.def"
#undef PARAMETER
    return hash;
}

void render_settings_take(struct render_settings *settings, const struct render_settings *from,
                          uint32_t parts)
{
#define PARAMETER(record, name, type, range, unit, initial, handling, redraw, ...)                 \
    if (parts == INVALIDATES_##redraw)                                                             \
        settings->name = from->name;
#include "protocol/parameters/settings.def"
#undef PARAMETER
}

// A setting that invalidates nothing would never reach the image.
#define PARAMETER(record, name, type, range, unit, initial, handling, redraw, ...)                 \
    _Static_assert(INVALIDATES_##redraw != INVALIDATES_NOTHING, #name);
#include "protocol/parameters/settings.def"
#undef PARAMETER

bool debug_view_needs_voxels(enum debug_view view)
{
    return view >= DEBUG_VIEW_VOXEL_OPACITY && view <= DEBUG_VIEW_CACHE_AGE;
}
