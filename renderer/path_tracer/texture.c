#include "renderer/path_tracer/texture.h"

#include <pthread.h>

static float srgb_values[256]; // sRGB decoded
static pthread_once_t srgb_once = PTHREAD_ONCE_INIT;

// IEC 61966-2-1.
static void fill_srgb_values(void)
{
    for (int i = 0; i < 256; i++) {
        double value = i / 255.0;
        srgb_values[i] =
            (float)(value <= 0.04045 ? value / 12.92 : pow((value + 0.055) / 1.055, 2.4));
    }
}

void texture_init(struct texture *texture, const struct scene *scene,
                  const struct scene_texture *source, bool is_color)
{
    pthread_once(&srgb_once, fill_srgb_values);
    float cosine = cosf(source->rotation_rad), sine = sinf(source->rotation_rad);
    // KHR_texture_transform rotates counter-clockwise with V pointing down.
    *texture = (struct texture){
        .image = scene->images[source->image],
        .is_color = is_color,
        .row_u = {cosine * source->scale[0], sine * source->scale[1], source->offset[0]},
        .row_v = {-sine * source->scale[0], cosine * source->scale[1], source->offset[1]},
        .wrap_u = source->wrap_u,
        .wrap_v = source->wrap_v,
        .nearest = source->nearest,
        .uv_set = source->uv_set,
    };
}

// Applies the wrap mode to a texel index of a row or column of `count`.
static uint32_t wrap_index(int64_t index, uint32_t count, enum scene_wrap wrap)
{
    if (index >= 0 && index < count)
        return (uint32_t)index;
    if (wrap == SCENE_WRAP_CLAMP_TO_EDGE)
        return index < 0 ? 0 : count - 1;
    int64_t period = wrap == SCENE_WRAP_MIRRORED_REPEAT ? 2 * (int64_t)count : count;
    int64_t inside = index % period;
    inside += inside < 0 ? period : 0;
    return (uint32_t)(inside < count ? inside : period - 1 - inside);
}

static float3 texel_at(const struct texture *texture, uint32_t column, uint32_t row)
{
    const uint8_t *texel =
        texture->image->rgba + ((size_t)row * texture->image->width + column) * 4;
    float alpha = (float)texel[3] * (1.0f / 255.0f);
    if (texture->is_color)
        return (float3){srgb_values[texel[0]], srgb_values[texel[1]], srgb_values[texel[2]], alpha};
    float3 rgb = {(float)texel[0], (float)texel[1], (float)texel[2], (float)texel[3]};
    return rgb * (1.0f / 255.0f);
}

// First texel of a look-up, and the fraction beyond it.
struct texel_position {
    float left, top;
    float across, down;
};

// False for coordinates out of range.
static inline bool find_texel(const struct texture *texture, const float uv[2],
                              struct texel_position *out_position)
{
    float center = texture->nearest ? 0.0f : 0.5f;
    float u = texture->row_u[0] * uv[0] + texture->row_u[1] * uv[1] + texture->row_u[2];
    float v = texture->row_v[0] * uv[0] + texture->row_v[1] * uv[1] + texture->row_v[2];
    float x = u * (float)texture->image->width - center;
    float y = v * (float)texture->image->height - center;
    if (!(fabsf(x) < 1e15f && fabsf(y) < 1e15f))
        return false;
    out_position->left = floorf(x);
    out_position->top = floorf(y);
    out_position->across = x - out_position->left;
    out_position->down = y - out_position->top;
    return true;
}

void texture_prefetch(const struct texture *texture, const float uv[2])
{
    const struct image *image = texture->image;
    struct texel_position texel_position;
    if (!find_texel(texture, uv, &texel_position))
        return;
    uint32_t column = wrap_index((int64_t)texel_position.left, image->width, texture->wrap_u);
    uint32_t row = wrap_index((int64_t)texel_position.top, image->height, texture->wrap_v);
    uint32_t next_row = wrap_index((int64_t)texel_position.top + 1, image->height, texture->wrap_v);
    __builtin_prefetch(image->rgba + ((size_t)row * image->width + column) * 4);
    __builtin_prefetch(image->rgba + ((size_t)next_row * image->width + column) * 4);
}

float3 texture_get(const struct texture *texture, const float uv[2])
{
    const struct image *image = texture->image;
    struct texel_position texel_position;
    if (!find_texel(texture, uv, &texel_position))
        return splat3(1.0f);
    uint32_t column = wrap_index((int64_t)texel_position.left, image->width, texture->wrap_u);
    uint32_t row = wrap_index((int64_t)texel_position.top, image->height, texture->wrap_v);
    if (texture->nearest)
        return texel_at(texture, column, row);
    uint32_t next_column =
        wrap_index((int64_t)texel_position.left + 1, image->width, texture->wrap_u);
    uint32_t next_row = wrap_index((int64_t)texel_position.top + 1, image->height, texture->wrap_v);
    float3 upper = texel_at(texture, column, row) * (1.0f - texel_position.across) +
                   texel_at(texture, next_column, row) * texel_position.across;
    float3 lower = texel_at(texture, column, next_row) * (1.0f - texel_position.across) +
                   texel_at(texture, next_column, next_row) * texel_position.across;
    return upper * (1.0f - texel_position.down) + lower * texel_position.down;
}

float3 texture_mean(const struct texture *texture)
{
    double sums[4] = {0};
    for (uint32_t row = 0; row < texture->image->height; row++)
        for (uint32_t column = 0; column < texture->image->width; column++) {
            float3 texel = texel_at(texture, column, row);
            for (int c = 0; c < 4; c++)
                sums[c] += texel[c];
        }
    double count = (double)texture->image->width * texture->image->height;
    return (float3){(float)(sums[0] / count), (float)(sums[1] / count), (float)(sums[2] / count),
                    (float)(sums[3] / count)};
}
