// One depth texture array for all shadow maps: layers of the scene's lights, then layers of views'
// cascades. One array, because a software renderer pays for every sampler that a shader declares.
#ifndef VOXCAST_RENDERER_GPU_SCENE_SHADOW_MAP_H
#define VOXCAST_RENDERER_GPU_SCENE_SHADOW_MAP_H

#include "renderer/gpu/texture.h"

struct shadow_map;

// NULL when memory runs out. Creates no texture before shadow_map_allocate().
struct shadow_map *shadow_map_create(struct gpu *gpu, uint32_t edge);
void shadow_map_destroy(struct shadow_map **map);

// Reserves at least `layers` light layers.
void shadow_map_reserve_lights(struct shadow_map *map, uint32_t layers);

// Reserves or returns the number of a view's cascade. UINT32_MAX when there are too many.
uint32_t shadow_map_take_cascade(struct shadow_map *map);
void shadow_map_give_cascade(struct shadow_map *map, uint32_t cascade);

// Creates the texture for all layers that are reserved, unless it is there: once for the lights and
// the first view, since a CPU driver writes all of it. False when GPU memory runs out.
bool shadow_map_allocate(struct shadow_map *map);

// Layer of a cascade in the texture; changes with the epoch.
uint32_t shadow_map_cascade_layer(const struct shadow_map *map, uint32_t cascade);

// Counts how often the texture was recreated and lost its contents. Store it with what was
// rendered, and render again when it differs.
uint64_t shadow_map_epoch(const struct shadow_map *map);

// NULL while there is no layer, and before shadow_map_allocate().
const struct gpu_texture *shadow_map_texture(const struct shadow_map *map);
const struct gpu_framebuffer *shadow_map_light_framebuffer(const struct shadow_map *map,
                                                           uint32_t light);
const struct gpu_framebuffer *shadow_map_cascade_framebuffer(const struct shadow_map *map,
                                                             uint32_t cascade);

#endif
