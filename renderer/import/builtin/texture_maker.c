#include "renderer/import/builtin/texture_maker.h"

#include <math.h>
#include <stdlib.h>

static uint8_t to_byte(float value)
{
    return (uint8_t)(fminf(fmaxf(value, 0.0f), 1.0f) * 255.0f + 0.5f);
}

// Takes ownership of `rgba`.
static uint32_t add_picture(struct scene *scene, uint32_t edge, uint8_t *rgba)
{
    struct image *image = image_create(edge, edge, rgba);
    if (!image) {
        free(rgba);
        return SCENE_NONE;
    }
    uint32_t id = scene_add_image(scene, image);
    image_release(&image);
    return id;
}

uint32_t texture_make(struct scene *scene, uint32_t edge, texture_function texel)
{
    uint8_t *rgba = malloc((size_t)edge * edge * 4);
    if (!rgba)
        return SCENE_NONE;
    for (uint32_t i = 0; i < edge * edge; i++) {
        float value[4] = {0.0f, 0.0f, 0.0f, 1.0f};
        texel(((float)(i % edge) + 0.5f) / (float)edge, ((float)(i / edge) + 0.5f) / (float)edge,
              value);
        for (uint32_t c = 0; c < 4; c++)
            rgba[4 * (size_t)i + c] = to_byte(value[c]);
    }
    return add_picture(scene, edge, rgba);
}

uint32_t texture_make_normal_map(struct scene *scene, uint32_t edge, height_function height)
{
    float *heights = malloc((size_t)edge * edge * sizeof(*heights));
    uint8_t *rgba = malloc((size_t)edge * edge * 4);
    if (!heights || !rgba) {
        free(heights);
        free(rgba);
        return SCENE_NONE;
    }
    for (uint32_t i = 0; i < edge * edge; i++)
        heights[i] = height(((float)(i % edge) + 0.5f) / (float)edge,
                            ((float)(i / edge) + 0.5f) / (float)edge);
    for (uint32_t row = 0; row < edge; row++)
        for (uint32_t column = 0; column < edge; column++) {
            uint32_t left = (column + edge - 1) % edge, right = (column + 1) % edge;
            uint32_t above = (row + edge - 1) % edge, below = (row + 1) % edge;
            float scale = 0.5f * (float)edge;
            float x = (heights[row * edge + left] - heights[row * edge + right]) * scale;
            float y = (heights[below * edge + column] - heights[above * edge + column]) * scale;
            float length = sqrtf(x * x + y * y + 1.0f);
            uint8_t *texel = rgba + 4 * ((size_t)row * edge + column);
            texel[0] = to_byte(0.5f + 0.5f * x / length);
            texel[1] = to_byte(0.5f + 0.5f * y / length);
            texel[2] = to_byte(0.5f + 0.5f / length);
            texel[3] = 255;
        }
    free(heights);
    return add_picture(scene, edge, rgba);
}

float texture_random(uint32_t x, uint32_t y, uint32_t seed)
{
    // Two rounds of multiply and xor-shift over a sum with odd factors.
    uint32_t h = x * 0x9e3779b1u + y * 0x85ebca77u + seed * 0xc2b2ae3du;
    h = (h ^ h >> 15) * 0x2c1b3c6du;
    h = (h ^ h >> 12) * 0x297a2d39u;
    return (float)((h ^ h >> 15) >> 8) * 0x1p-24f;
}

float texture_noise(float u, float v, uint32_t period, uint32_t seed)
{
    float x = (u - floorf(u)) * (float)period, y = (v - floorf(v)) * (float)period;
    uint32_t left = (uint32_t)x % period, top = (uint32_t)y % period;
    uint32_t right = (left + 1) % period, bottom = (top + 1) % period;
    float s = x - floorf(x), t = y - floorf(y);
    s = s * s * (3.0f - 2.0f * s);
    t = t * t * (3.0f - 2.0f * t);
    float upper =
        texture_random(left, top, seed) * (1.0f - s) + texture_random(right, top, seed) * s;
    float lower =
        texture_random(left, bottom, seed) * (1.0f - s) + texture_random(right, bottom, seed) * s;
    return upper * (1.0f - t) + lower * t;
}

float texture_turbulence(float u, float v, uint32_t period, uint32_t octaves, uint32_t seed)
{
    float sum = 0.0f, weight = 0.5f, all = 0.0f;
    for (uint32_t i = 0; i < octaves; i++, weight *= 0.5f) {
        sum += weight * texture_noise(u, v, period << i, seed + i);
        all += weight;
    }
    return sum / all;
}
