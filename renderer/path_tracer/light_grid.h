// Which punctual lights reach where: a grid of cells over the scene's bounds, each with the lights
// whose range touches it. Exact, since light is 0 beyond its range (KHR_lights_punctual).
#ifndef VOXCAST_RENDERER_PATH_TRACER_LIGHT_GRID_H
#define VOXCAST_RENDERER_PATH_TRACER_LIGHT_GRID_H

#include <stdbool.h>
#include <stdint.h>

#include "renderer/path_tracer/vector.h"

struct light_reach {
    float3 position;
    float range_m; // 0: everywhere
};

struct light_grid {
    float3 low, cells_per_m;
    uint32_t *starts; // by cell, and one more; NULL: no grid
    uint32_t *lights;
};

// No grid, but no failure either, where lights reach so much that their lists would be too long.
// False when out of memory.
bool light_grid_init(struct light_grid *grid, float3 low, float3 high,
                     const struct light_reach *reaches, uint32_t count);
void light_grid_finish(struct light_grid *grid);

// The lights that may reach a point; false if the grid does not know.
bool light_grid_find(const struct light_grid *grid, float3 position, const uint32_t **out_lights,
                     uint32_t *out_count);

#endif
