#include "renderer/scene/texture_sample.h"

#include <math.h>
#include <stddef.h>

static void transform_uv(const struct scene_texture *texture, const float uv[2], double out[2])
{
    double u = (double)uv[0] * texture->scale[0];
    double v = (double)uv[1] * texture->scale[1];
    double cosine = cos(texture->rotation_rad);
    double sine = sin(texture->rotation_rad);
    // KHR_texture_transform rotates counter-clockwise with V pointing down.
    out[0] = texture->offset[0] + cosine * u + sine * v;
    out[1] = texture->offset[1] - sine * u + cosine * v;
}

// Applies the wrap mode to `index` in a row or column of `count` texels.
static uint32_t wrap_index(int64_t index, uint32_t count, enum scene_wrap wrap)
{
    int64_t size = count;
    if (wrap == SCENE_WRAP_CLAMP_TO_EDGE) {
        return (uint32_t)(index < 0 ? 0 : index >= size ? size - 1 : index);
    }
    int64_t period = wrap == SCENE_WRAP_MIRRORED_REPEAT ? 2 * size : size;
    int64_t inside = index % period;
    inside += inside < 0 ? period : 0;
    return (uint32_t)(inside < size ? inside : period - 1 - inside);
}

static const uint8_t *texel_at(const struct image *image, const struct scene_texture *texture,
                               int64_t x, int64_t y)
{
    uint32_t column = wrap_index(x, image->width, texture->wrap_u);
    uint32_t row = wrap_index(y, image->height, texture->wrap_v);
    return image->rgba + ((size_t)row * image->width + column) * 4;
}

void texture_sample(const struct scene *scene, const struct scene_texture *texture,
                    const float uv[2], float out_rgba[4])
{
    double at[2];
    transform_uv(texture, uv, at);
    const struct image *image = texture->image == SCENE_NONE ? NULL : scene->images[texture->image];
    if (!image || !image->rgba || !isfinite(at[0]) || !isfinite(at[1])) {
        out_rgba[0] = out_rgba[1] = out_rgba[2] = out_rgba[3] = 1.0f;
        return;
    }
    double center = texture->nearest ? 0.0 : 0.5;
    double x = fmax(-1e15, fmin(1e15, at[0] * image->width - center));
    double y = fmax(-1e15, fmin(1e15, at[1] * image->height - center));
    int64_t column = (int64_t)floor(x);
    int64_t row = (int64_t)floor(y);
    double along_x = texture->nearest ? 0.0 : x - (double)column;
    double along_y = texture->nearest ? 0.0 : y - (double)row;
    const uint8_t *corners[2][2];
    for (int i = 0; i < 4; i++) {
        corners[i / 2][i % 2] = texel_at(image, texture, column + i % 2, row + i / 2);
    }
    for (int channel = 0; channel < 4; channel++) {
        double upper = corners[0][0][channel] * (1 - along_x) + corners[0][1][channel] * along_x;
        double lower = corners[1][0][channel] * (1 - along_x) + corners[1][1][channel] * along_x;
        out_rgba[channel] = (float)((upper * (1 - along_y) + lower * along_y) / 255.0);
    }
}
