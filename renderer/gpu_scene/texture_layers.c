#include "renderer/gpu_scene/texture_layers.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define STB_IMAGE_RESIZE_IMPLEMENTATION
#define STB_IMAGE_RESIZE_STATIC
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb_image_resize.h>
#pragma GCC diagnostic pop

#include "renderer/gpu/texture.h"

// Of entries in the scene cache. Raise it when decoding, scaling or means change, or the layout:
// four floats of the mean, then the levels.
#define LAYER_VERSION 1
#define MEAN_BYTES    (4 * sizeof(float))

static float linear_from_srgb(float value)
{
    return value <= 0.04045f ? value / 12.92f : powf((value + 0.055f) / 1.055f, 2.4f);
}

static void compute_mean(const struct image *image, bool color, float out_mean[4])
{
    uint64_t count = (uint64_t)image->width * image->height;
    uint64_t step = count > 4096 ? count / 4096 : 1; // an estimate is enough
    double sum[4] = {0};
    uint64_t taken = 0;
    for (uint64_t i = 0; i < count; i += step, taken++)
        for (int c = 0; c < 4; c++) {
            float value = image->rgba[i * 4 + c] / 255.0f;
            sum[c] += color && c < 3 ? linear_from_srgb(value) : value;
        }
    for (int c = 0; c < 4; c++)
        out_mean[c] = taken ? (float)(sum[c] / (double)taken) : 1.0f;
}

// Writes an image to a layer, scaled to the class's edge.
static bool write_layer(struct gpu_texture *texture, uint32_t layer, const struct image *image,
                        bool color)
{
    uint32_t edge = gpu_texture_edge(texture);
    if (image->width == edge && image->height == edge) {
        gpu_texture_write(texture, 0, layer, image->rgba);
        return true;
    }
    uint8_t *scaled = malloc((size_t)edge * edge * 4);
    if (!scaled)
        return false;
    stbir_resize_uint8_generic(image->rgba, (int)image->width, (int)image->height, 0, scaled,
                               (int)edge, (int)edge, 0, 4, 3, STBIR_FLAG_ALPHA_PREMULTIPLIED,
                               STBIR_EDGE_WRAP, STBIR_FILTER_DEFAULT,
                               color ? STBIR_COLORSPACE_SRGB : STBIR_COLORSPACE_LINEAR, NULL);
    gpu_texture_write(texture, 0, layer, scaled);
    free(scaled);
    return true;
}

// The driver makes the levels, so they are those of one driver.
static struct cache_key key_of(const struct texture_layer *layer)
{
    const struct renderer_info *info = gpu_get_info(layer->gpu);
    const uint32_t shape[2] = {gpu_texture_edge(layer->texture), layer->color};
    struct cache_key key = cache_key_start("texture layer", LAYER_VERSION);
    cache_key_add(&key, info->gl_renderer, strlen(info->gl_renderer));
    cache_key_add(&key, info->gl_version, strlen(info->gl_version));
    cache_key_add(&key, shape, sizeof(shape));
    image_add_to_key(layer->image, &key);
    return key;
}

static size_t level_bytes(const struct texture_layer *layer, uint32_t level)
{
    size_t edge = gpu_texture_edge(layer->texture) >> level;
    return 4 * edge * edge;
}

static size_t entry_bytes(const struct texture_layer *layer)
{
    size_t bytes = MEAN_BYTES;
    for (uint32_t level = 0; level < gpu_texture_levels(layer->texture); level++)
        bytes += level_bytes(layer, level);
    return bytes;
}

static bool load_from_cache(const struct texture_layer *layer, float out_mean[4])
{
    if (!scene_cache_is_open())
        return false;
    struct cache_key key = key_of(layer);
    size_t size = 0, expected = entry_bytes(layer);
    uint8_t *entry = scene_cache_read(&key, expected, &size);
    bool found = entry && size == expected;
    if (found) {
        memcpy(out_mean, entry, MEAN_BYTES);
        const uint8_t *at = entry + MEAN_BYTES;
        for (uint32_t level = 0; level < gpu_texture_levels(layer->texture); level++) {
            gpu_texture_write(layer->texture, level, layer->layer, at);
            at += level_bytes(layer, level);
        }
    }
    free(entry);
    return found;
}

bool texture_layer_load(const struct texture_layer *layer, float out_mean[4], bool *out_whole)
{
    *out_whole = load_from_cache(layer, out_mean);
    if (*out_whole)
        return true;
    if (!image_pin(layer->image))
        return false;
    compute_mean(layer->image, layer->color, out_mean);
    bool done = write_layer(layer->texture, layer->layer, layer->image, layer->color);
    image_unpin(layer->image);
    return done;
}

void texture_layer_keep(const struct texture_layer *layer, const float mean[4])
{
    size_t size = entry_bytes(layer);
    uint8_t *entry = malloc(size), *at = entry + MEAN_BYTES;
    if (!entry)
        return;
    memcpy(entry, mean, MEAN_BYTES);
    for (uint32_t level = 0; level < gpu_texture_levels(layer->texture); level++) {
        gpu_texture_read_layer(layer->texture, level, layer->layer, at);
        at += level_bytes(layer, level);
    }
    struct cache_key key = key_of(layer);
    scene_cache_write(&key, entry, size);
    free(entry);
}
