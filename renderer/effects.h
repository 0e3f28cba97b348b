// Which effects a frame needs, and why: only these get shader code, passes and memory.
#ifndef VOXCAST_RENDERER_EFFECTS_H
#define VOXCAST_RENDERER_EFFECTS_H

#include "renderer/renderer.h"

enum effect {
    EFFECT_TEXTURES,
    EFFECT_ALPHA_MASK,
    EFFECT_VERTEX_COLORS,
    EFFECT_SPECULAR, // any material that reflects like a mirror or gloss
    EFFECT_PUNCTUAL_LIGHTS,
    EFFECT_AREA_LIGHTS, // planar emitters
    EFFECT_SHADOWS,
    EFFECT_FLAT_SHADOWS, // of the sun and of spots: one view each
    EFFECT_CUBE_SHADOWS, // of lamps that shine all around: six views each
    EFFECT_LIGHT_TILES,  // lights of limited range
    EFFECT_BLINN_PHONG,
    EFFECT_ENVIRONMENT,
    EFFECT_TRANSPARENCY, // blended or transmissive materials
    EFFECT_AUTO_EXPOSURE,
    EFFECT_COUNT
};

#define EFFECT_BIT(effect) (1u << (effect))

// What picks the code of shaders/lib/lighting.glsl and shaders/lib/geometry.glsl.
#define DIRECT_LIGHT_EFFECTS                                                                       \
    (EFFECT_BIT(EFFECT_SHADOWS) | EFFECT_BIT(EFFECT_FLAT_SHADOWS) |                                \
     EFFECT_BIT(EFFECT_CUBE_SHADOWS) | EFFECT_BIT(EFFECT_LIGHT_TILES) |                            \
     EFFECT_BIT(EFFECT_PUNCTUAL_LIGHTS) | EFFECT_BIT(EFFECT_AREA_LIGHTS) |                         \
     EFFECT_BIT(EFFECT_BLINN_PHONG) | EFFECT_BIT(EFFECT_SPECULAR))
#define SURFACE_EFFECTS (EFFECT_BIT(EFFECT_TEXTURES) | EFFECT_BIT(EFFECT_VERTEX_COLORS))

struct resident;

struct effect_plan {
    uint32_t bits;
    char reasons[EFFECT_COUNT][96];
};

// Reads what the scene holds and what the settings ask for.
void effects_plan(struct effect_plan *plan, const struct resident *resident,
                  const struct frame_params *params);

const char *effect_name(enum effect effect);

// Writes "NAME 0|1" lines for the effects in `mask`, and what kinds of textures there are if
// EFFECT_TEXTURES is among them: the defines of a shader permutation.
void effects_write_defines(uint32_t bits, uint32_t mask, const struct resident *resident,
                           char *out_text, size_t out_size);

#endif
