// Punctual lights by position: a grid over the scene's bounds with the lights whose range reaches
// each cell. Exact, since light is 0 beyond its range (KHR_lights_punctual).
#ifndef VOXCAST_RENDERER_PATH_TRACER_LIGHT_GRID_H
#define VOXCAST_RENDERER_PATH_TRACER_LIGHT_GRID_H

#include <stdbool.h>
#include <stdint.h>

#include "renderer/path_tracer/vector.h"

struct light_reach {
    float3 position;
    float range_m; // 0: unlimited
};

struct light_grid {
    float3 low, cells_per_m;
    uint32_t *starts; // per cell, plus one; NULL: no grid
    uint32_t *lights;
};

// Leaves out the grid, and succeeds, if the lists would be too long. False when out of memory.
bool light_grid_init(struct light_grid *grid, float3 low, float3 high,
                     const struct light_reach *reaches, uint32_t count);
void light_grid_finish(struct light_grid *grid);

// Lights that may reach a point; false if there is no grid for it.
bool light_grid_find(const struct light_grid *grid, float3 position, const uint32_t **out_lights,
                     uint32_t *out_count);

#endif
