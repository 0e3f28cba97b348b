// Which effects a frame needs, and why: only these get shader code, passes and memory. Made from
// the rows of frame.def.
#ifndef VOXCAST_RENDERER_FRAME_EFFECTS_H
#define VOXCAST_RENDERER_FRAME_EFFECTS_H

#include <stdbool.h>
#include <stdint.h>

// What a method of global illumination offers: effects are planned by it, and passes ask for it.
enum gi_capability {
    GI_HAS_CONES = 1, // filtered voxels that cones are traced through, and a cache of irradiance
    GI_HAS_CLIP_LEVELS = 2, // several levels with cells of their own
    GI_IS_REFERENCE = 4,    // makes the whole image itself
};

enum effect {
#define EFFECT(id, ...) EFFECT_##id,
#include "renderer/frame/frame.def"
#undef EFFECT
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
struct effect_plan {
    uint32_t bits;
    bool calls_for_cones; // one of them is on that needs the scene's voxels
    char reasons[EFFECT_COUNT][96];
};

struct frame_inputs;
struct quality_level;

// Plans effects from the scene's contents and the settings; `quality` is what they resolve to.
void effects_plan(struct effect_plan *plan, const struct frame_inputs *in,
                  const struct quality_level *quality);

const char *effect_name(enum effect effect);
const char *effect_define(enum effect effect);

#endif
