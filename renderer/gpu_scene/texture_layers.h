// Layers of texture arrays, made from images or taken from the scene cache.
#ifndef VOXCAST_RENDERER_GPU_SCENE_TEXTURE_LAYERS_H
#define VOXCAST_RENDERER_GPU_SCENE_TEXTURE_LAYERS_H

#include "renderer/gpu/gpu.h"
#include "renderer/image/image.h"

// A layer of a square array, and the image that fills it.
struct texture_layer {
    struct gpu *gpu;
    struct gpu_texture *texture;
    uint32_t layer;
    struct image *image;
    bool color; // sRGB
};

// Fills the layer's levels from the scene cache, where it holds them, or else its finest alone from
// the image, scaled to the array's edge: *out_whole says which. `out_mean` is the image's mean,
// linear. False when memory runs out.
bool texture_layer_load(const struct texture_layer *layer, float out_mean[4], bool *out_whole);

// Puts the layer with all its levels into the scene cache. Waits for the GPU.
void texture_layer_keep(const struct texture_layer *layer, const float mean[4]);

#endif
