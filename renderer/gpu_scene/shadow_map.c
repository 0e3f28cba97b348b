#include "renderer/gpu_scene/shadow_map.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "renderer/gpu_scene/gpu_scene.h"

#define MAX_LAYERS (MAX_SHADOW_LAYERS + MAX_VIEW_CASCADES)

struct shadow_map {
    struct gpu *gpu;
    uint32_t edge;
    uint64_t epoch;
    struct gpu_texture *texture;
    bool cascade_taken[MAX_VIEW_CASCADES];
    uint32_t lights;   // layers 0 to lights - 1 exist for lights
    uint32_t cascades; // and this many for cascades
    struct gpu_framebuffer
        *framebuffers[MAX_LAYERS]; // lights from 0, cascades from MAX_SHADOW_LAYERS
};

struct shadow_map *shadow_map_create(struct gpu *gpu, uint32_t edge)
{
    struct shadow_map *map = calloc(1, sizeof(*map));
    if (!map)
        return NULL;
    map->gpu = gpu;
    map->edge = edge;
    return map;
}

static void destroy_texture(struct shadow_map *map)
{
    for (uint32_t i = 0; i < MAX_LAYERS; i++)
        gpu_framebuffer_destroy(&map->framebuffers[i]);
    gpu_texture_destroy(&map->texture);
}

void shadow_map_destroy(struct shadow_map **map)
{
    if (*map)
        destroy_texture(*map);
    free(*map);
    *map = NULL;
}

static void resize(struct shadow_map *map, uint32_t lights, uint32_t cascades)
{
    destroy_texture(map);
    map->lights = lights;
    map->cascades = cascades;
    map->epoch++;
}

bool shadow_map_allocate(struct shadow_map *map)
{
    uint32_t lights = map->lights, layers = map->lights + map->cascades;
    if (map->texture || layers == 0)
        return true;
    map->texture = gpu_texture_create(map->gpu, &(struct gpu_texture_params){
                                                    .label = "shadow_maps",
                                                    .format = GPU_FORMAT_DEPTH32F,
                                                    .width = map->edge,
                                                    .height = map->edge,
                                                    .layers = layers,
                                                    .filter = GPU_FILTER_SHADOW_COMPARE,
                                                });
    bool done = map->texture != NULL;
    for (uint32_t i = 0; i < layers && done; i++) {
        uint32_t slot = i < lights ? i : MAX_SHADOW_LAYERS + i - lights;
        map->framebuffers[slot] =
            gpu_framebuffer_create(map->gpu, "shadow_map", NULL, map->texture, i);
        done = map->framebuffers[slot] != NULL;
    }
    if (!done)
        destroy_texture(map);
    return done;
}

void shadow_map_reserve_lights(struct shadow_map *map, uint32_t layers)
{
    assert(layers <= MAX_SHADOW_LAYERS);
    bool cascades = false;
    for (uint32_t i = 0; i < MAX_VIEW_CASCADES; i++)
        cascades = cascades || map->cascade_taken[i];
    if (layers == 0 && !cascades && map->lights + map->cascades > 0)
        resize(map, 0, 0);
    if (layers > map->lights)
        resize(map, layers, map->cascades);
}

uint32_t shadow_map_take_cascade(struct shadow_map *map)
{
    for (uint32_t i = 0; i < MAX_VIEW_CASCADES; i++) {
        if (map->cascade_taken[i])
            continue;
        if (i >= map->cascades)
            resize(map, map->lights, i + 1);
        map->cascade_taken[i] = true;
        return i;
    }
    return UINT32_MAX;
}

void shadow_map_give_cascade(struct shadow_map *map, uint32_t cascade)
{
    assert(map->cascade_taken[cascade]);
    map->cascade_taken[cascade] = false;
}

uint64_t shadow_map_epoch(const struct shadow_map *map)
{
    return map->epoch;
}

const struct gpu_texture *shadow_map_texture(const struct shadow_map *map)
{
    return map->texture;
}

uint32_t shadow_map_cascade_layer(const struct shadow_map *map, uint32_t cascade)
{
    return map->lights + cascade;
}

const struct gpu_framebuffer *shadow_map_light_framebuffer(const struct shadow_map *map,
                                                           uint32_t light)
{
    return map->framebuffers[light];
}

const struct gpu_framebuffer *shadow_map_cascade_framebuffer(const struct shadow_map *map,
                                                             uint32_t cascade)
{
    return map->framebuffers[MAX_SHADOW_LAYERS + cascade];
}
