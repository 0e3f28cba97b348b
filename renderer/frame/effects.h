// Which effects a frame needs, and why. Only these get shader code, passes and memory.
#ifndef VOXCAST_RENDERER_FRAME_EFFECTS_H
#define VOXCAST_RENDERER_FRAME_EFFECTS_H

#include <stddef.h>

#include "renderer/frame/frame_params.h"
#include "renderer/frame/frame_statistics.h"

// What a method of global illumination offers: effects are planned by it, and passes ask for it.
enum gi_capability {
    GI_HAS_CONES = 1, // filtered voxels that cones are traced through, and a cache of irradiance
    GI_HAS_CLIP_LEVELS = 2, // several levels with cells of their own
    GI_IS_REFERENCE = 4,    // makes the whole image itself
};

enum effect {
    EFFECT_TEXTURES,
    EFFECT_ALPHA_MASK,
    EFFECT_VERTEX_COLORS,
    EFFECT_SPECULAR, // any material with a specular lobe
    EFFECT_PUNCTUAL_LIGHTS,
    EFFECT_AREA_LIGHTS, // planar emitters
    EFFECT_SHADOWS,
    EFFECT_SINGLE_VIEW_SHADOWS, // directional and spot lights: one view each
    EFFECT_POINT_SHADOWS,       // point lights: six views each
    EFFECT_LIGHT_TILES,         // lights of limited range
    EFFECT_BLINN_PHONG,
    EFFECT_ENVIRONMENT,
    EFFECT_TRANSPARENCY, // blended or transmissive materials
    EFFECT_AUTO_EXPOSURE,
    EFFECT_INDIRECT_DIFFUSE,  // diffuse indirect light; this and all below need voxels
    EFFECT_MULTI_BOUNCE,      // more than one bounce
    EFFECT_INDIRECT_SPECULAR, // traced reflections
    EFFECT_REFRACTION,
    EFFECT_SOFT_SHADOWS, // of area and sphere lights
    EFFECT_AMBIENT_OCCLUSION,
    EFFECT_ENVIRONMENT_LIGHT, // cones that miss the scene sample the environment
    EFFECT_VOXEL_COLORS,      // textures or vertex colours in voxels
    EFFECT_CLIP_LEVELS,       // clip levels rather than one grid
    EFFECT_COUNT
};

#define EFFECT_BIT(effect) (1u << (effect))

// Effects that select code of shaders/lib/lighting.glsl and shaders/lib/geometry.glsl.
#define DIRECT_LIGHT_EFFECTS                                                                       \
    (EFFECT_BIT(EFFECT_SHADOWS) | EFFECT_BIT(EFFECT_SINGLE_VIEW_SHADOWS) |                         \
     EFFECT_BIT(EFFECT_POINT_SHADOWS) | EFFECT_BIT(EFFECT_LIGHT_TILES) |                           \
     EFFECT_BIT(EFFECT_PUNCTUAL_LIGHTS) | EFFECT_BIT(EFFECT_AREA_LIGHTS) |                         \
     EFFECT_BIT(EFFECT_BLINN_PHONG) | EFFECT_BIT(EFFECT_SPECULAR) |                                \
     EFFECT_BIT(EFFECT_INDIRECT_DIFFUSE))
// Effects that need the scene's voxels.
#define VOXEL_EFFECTS                                                                              \
    (EFFECT_BIT(EFFECT_INDIRECT_DIFFUSE) | EFFECT_BIT(EFFECT_INDIRECT_SPECULAR) |                  \
     EFFECT_BIT(EFFECT_REFRACTION) | EFFECT_BIT(EFFECT_SOFT_SHADOWS) |                             \
     EFFECT_BIT(EFFECT_AMBIENT_OCCLUSION))
#define SURFACE_EFFECTS (EFFECT_BIT(EFFECT_TEXTURES) | EFFECT_BIT(EFFECT_VERTEX_COLORS))

struct gpu_scene;

struct effect_plan {
    uint32_t bits;
    char reasons[EFFECT_COUNT][96];
};

// Plans effects from the scene's contents and the settings.
void effects_plan(struct effect_plan *plan, const struct gpu_scene *gpu_scene,
                  const struct frame_params *params, uint32_t gi_capabilities);

const char *effect_name(enum effect effect);

// Writes the defines of a shader permutation: a line "NAME 0|1" for each effect in `mask` and, if
// EFFECT_TEXTURES is among them, which kinds of textures exist.
void effects_write_defines(uint32_t bits, uint32_t mask, const struct gpu_scene *gpu_scene,
                           char *out_text, size_t out_size);

#endif
