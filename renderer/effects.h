// Which effects a frame needs, and why: only these get shader code, passes and memory.
#ifndef VOXCAST_RENDERER_EFFECTS_H
#define VOXCAST_RENDERER_EFFECTS_H

#include "renderer/renderer.h"

enum effect {
    EFFECT_TEXTURES,
    EFFECT_ALPHA_MASK,
    EFFECT_LIGHTS,      // any enabled punctual light or planar emitter
    EFFECT_AREA_LIGHTS, // planar emitters
    EFFECT_SHADOWS,
    EFFECT_LIGHT_TILES, // lights of limited range
    EFFECT_BLINN_PHONG,
    EFFECT_ENVIRONMENT,
    EFFECT_TRANSPARENCY, // blended or transmissive materials
    EFFECT_AUTO_EXPOSURE,
    EFFECT_COUNT
};

#define EFFECT_BIT(effect) (1u << (effect))

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
