// A material's texture, prepared for fast look-ups at its finest level.
#ifndef VOXCAST_RENDERER_PATH_TRACER_TEXTURE_H
#define VOXCAST_RENDERER_PATH_TRACER_TEXTURE_H

#include "renderer/path_tracer/vector.h"
#include "renderer/scene/scene.h"

struct texture {
    const struct image *image;
    bool is_color;            // sRGB except alpha
    float row_u[3], row_v[3]; // u' = dot(row, (u, v, 1))
    enum scene_wrap wrap_u, wrap_v;
    bool nearest;
    uint32_t uv_set;
};

void texture_init(struct texture *texture, const struct scene *scene,
                  const struct scene_texture *source, bool is_color);

// Four linear values 0..1; bilinear over decoded texels, as on a GPU. `uv` is the vertices'.
float3 texture_get(const struct texture *texture, const float uv[2]);

// Prefetches the texels of texture_get(): several textures then take no longer than one.
void texture_prefetch(const struct texture *texture, const float uv[2]);

// The mean over all texels.
float3 texture_mean(const struct texture *texture);

#endif
