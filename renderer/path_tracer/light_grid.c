#include "renderer/path_tracer/light_grid.h"

#include <stdlib.h>

#define EDGE        16u
#define CELLS       (EDGE * EDGE * EDGE)
#define MAX_ENTRIES (4u << 20)

struct cell_box {
    uint32_t low[3], high[3]; // inclusive
};

static uint32_t clamp_cell(float cell)
{
    if (!(cell > 0.0f))
        return 0;
    return cell < (float)EDGE ? (uint32_t)cell : EDGE - 1;
}

static struct cell_box reached_cells(const struct light_grid *grid, const struct light_reach *reach)
{
    struct cell_box box = {{0, 0, 0}, {EDGE - 1, EDGE - 1, EDGE - 1}};
    if (!(reach->range_m > 0.0f))
        return box;
    float3 range = splat3(reach->range_m);
    float3 low = (reach->position - range - grid->low) * grid->cells_per_m;
    float3 high = (reach->position + range - grid->low) * grid->cells_per_m;
    for (int axis = 0; axis < 3; axis++) {
        // Padded against rounding.
        box.low[axis] = clamp_cell(low[axis] - 0.001f);
        box.high[axis] = clamp_cell(high[axis] + 0.001f);
    }
    return box;
}

// Counts the lights of each cell in starts[cell + 1] or, if there are lists, fills these.
static void visit(struct light_grid *grid, const struct light_reach *reaches, uint32_t count)
{
    for (uint32_t light = 0; light < count; light++) {
        struct cell_box box = reached_cells(grid, &reaches[light]);
        for (uint32_t z = box.low[2]; z <= box.high[2]; z++)
            for (uint32_t y = box.low[1]; y <= box.high[1]; y++)
                for (uint32_t x = box.low[0]; x <= box.high[0]; x++) {
                    uint32_t *start = &grid->starts[(z * EDGE + y) * EDGE + x];
                    if (grid->lights)
                        grid->lights[start[0]++] = light;
                    else
                        start[1]++;
                }
    }
}

bool light_grid_init(struct light_grid *grid, float3 low, float3 high,
                     const struct light_reach *reaches, uint32_t count)
{
    *grid = (struct light_grid){.low = low};
    for (int axis = 0; axis < 3; axis++)
        grid->cells_per_m[axis] = (float)EDGE / max1(high[axis] - low[axis], 1e-6f);
    grid->starts = calloc(CELLS + 1, sizeof(*grid->starts));
    if (!grid->starts)
        return false;
    uint64_t entries = 0;
    for (uint32_t light = 0; light < count; light++) {
        struct cell_box box = reached_cells(grid, &reaches[light]);
        uint64_t cells = 1;
        for (int axis = 0; axis < 3; axis++)
            cells *= box.high[axis] - box.low[axis] + 1;
        entries += cells;
    }
    if (entries > MAX_ENTRIES) {
        light_grid_finish(grid);
        return true;
    }
    visit(grid, reaches, count);
    for (uint32_t cell = 0; cell < CELLS; cell++)
        grid->starts[cell + 1] += grid->starts[cell];
    grid->lights = malloc((entries + 1) * sizeof(*grid->lights));
    if (!grid->lights) {
        light_grid_finish(grid);
        return false;
    }
    // Filling has moved each start to the next one's value: move them back.
    visit(grid, reaches, count);
    for (uint32_t cell = CELLS; cell > 0; cell--)
        grid->starts[cell] = grid->starts[cell - 1];
    grid->starts[0] = 0;
    return true;
}

void light_grid_finish(struct light_grid *grid)
{
    free(grid->starts);
    free(grid->lights);
    grid->starts = NULL;
    grid->lights = NULL;
}

bool light_grid_find(const struct light_grid *grid, float3 position, const uint32_t **out_lights,
                     uint32_t *out_count)
{
    if (!grid->starts)
        return false;
    float3 cell = (position - grid->low) * grid->cells_per_m;
    for (int axis = 0; axis < 3; axis++)
        if (!(cell[axis] > -0.5f && cell[axis] < (float)EDGE + 0.5f))
            return false;
    uint32_t index =
        (clamp_cell(cell[2]) * EDGE + clamp_cell(cell[1])) * EDGE + clamp_cell(cell[0]);
    *out_lights = grid->lights + grid->starts[index];
    *out_count = grid->starts[index + 1] - grid->starts[index];
    return true;
}
