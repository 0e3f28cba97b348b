// Procedural images that tile in both directions.
#ifndef VOXCAST_RENDERER_IMPORT_BUILTIN_TEXTURE_MAKER_H
#define VOXCAST_RENDERER_IMPORT_BUILTIN_TEXTURE_MAKER_H

#include "renderer/scene/scene.h"

// Colour of a texel at u, v in 0..1 (v down the image): 0..1 each, as stored in the file (sRGB for
// colours).
typedef void (*texture_function)(float u, float v, float out_rgba[4]);

// Height of a surface, in units of the image's edge.
typedef float (*height_function)(float u, float v);

// Each makes a square image and adds it to the scene. Returns its id, or SCENE_NONE when memory
// runs out.
uint32_t texture_make(struct scene *scene, uint32_t edge, texture_function texel);
uint32_t texture_make_normal_map(struct scene *scene, uint32_t edge, height_function height);

// Pseudo-random value in 0..1 of two integers and a seed; the same on every machine.
float texture_random(uint32_t x, uint32_t y, uint32_t seed);

// Smooth periodic noise in 0..1 over a lattice of period x period cells.
float texture_noise(float u, float v, uint32_t period, uint32_t seed);

// Sum of `octaves` noises, each at twice the frequency and half the amplitude; 0..1.
float texture_turbulence(float u, float v, uint32_t period, uint32_t octaves, uint32_t seed);

#endif
