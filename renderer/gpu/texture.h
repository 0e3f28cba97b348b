// GPU textures with immutable storage, and framebuffers.
#ifndef VOXCAST_RENDERER_GPU_TEXTURE_H
#define VOXCAST_RENDERER_GPU_TEXTURE_H

#include "renderer/gpu/gpu.h"

enum gpu_format {
    GPU_FORMAT_R32UI,
    GPU_FORMAT_RGBA32UI,
    GPU_FORMAT_DEPTH32F,
    GPU_FORMAT_RGBA8,
    GPU_FORMAT_SRGB8_ALPHA8,
    GPU_FORMAT_RGBA16F,
};

enum gpu_filter {
    GPU_FILTER_NEAREST,
    GPU_FILTER_LINEAR,               // and between mip levels, if any
    GPU_FILTER_LINEAR_NEAREST_LEVEL, // linear within the nearest mip level: half the texels
    GPU_FILTER_SHADOW_COMPARE        // linear comparison: reference >= depth (reversed Z)
};

struct gpu_texture_params {
    const char *label;
    enum gpu_format format;
    uint32_t width;
    uint32_t height;
    uint32_t layers; // 0: 2D; else a 2D array
    uint32_t depth;  // 0: as `layers` says; else 3D
    uint32_t levels; // 0 means 1
    enum gpu_filter filter;
    bool repeat_u; // false: clamp to edge
    bool repeat_v;
};

// NULL when GL runs out of memory.
struct gpu_texture *gpu_texture_create(struct gpu *gpu, const struct gpu_texture_params *params);
void gpu_texture_destroy(struct gpu_texture **texture);

// Uploads one level of one layer. Tightly packed rows of 4 bytes per texel (RGBA8 formats), 4
// floats (RGBA16F) or 4 words (RGBA32UI).
void gpu_texture_write(struct gpu_texture *texture, uint32_t level, uint32_t layer,
                       const void *pixels);
// Zeroes all levels.
void gpu_texture_clear(struct gpu_texture *texture);

// Copies a 3D texture to host memory, 4 floats per texel, x fastest; waits for the GPU. For tests.
void gpu_texture_read(const struct gpu_texture *texture, float *out_texels, size_t size_bytes);

// Copies one level of one layer to host memory, as gpu_texture_write() takes it (RGBA16F excepted);
// of sRGB as stored. A 2D texture is layer 0. Waits for the GPU.
void gpu_texture_read_layer(const struct gpu_texture *texture, uint32_t level, uint32_t layer,
                            void *out_pixels);

void gpu_texture_generate_levels(struct gpu_texture *texture);
uint32_t gpu_texture_name(const struct gpu_texture *texture);
uint64_t gpu_texture_size_bytes(const struct gpu_texture *texture);
uint32_t gpu_texture_levels(const struct gpu_texture *texture);
size_t gpu_texture_texel_count(const struct gpu_texture *texture, uint32_t level);
uint32_t gpu_texture_edge(const struct gpu_texture *texture); // width in texels

// An optional colour texture and a depth texture; `layer` selects the layer of an array.
struct gpu_framebuffer *gpu_framebuffer_create(struct gpu *gpu, const char *label,
                                               const struct gpu_texture *color,
                                               const struct gpu_texture *depth,
                                               uint32_t depth_layer);
void gpu_framebuffer_destroy(struct gpu_framebuffer **framebuffer);

#endif
