// How many voxels a scene occupies, before they are counted on the GPU: pools of about the right
// size spare voxelizing everything again for each time they grow.
#include <math.h>

#include "renderer/gi/voxel/volume.h"
#include "renderer/scene/scene.h"

// A plane of area A and unit normal n crosses A (|n.x| + |n.y| + |n.z|) / edge^2 voxels.
static float crossings(const float edge_b[3], const float edge_c[3])
{
    float sum = 0.0f;
    for (int axis = 0; axis < 3; axis++) {
        int next = (axis + 1) % 3, last = (axis + 2) % 3;
        sum += fabsf(edge_b[next] * edge_c[last] - edge_b[last] * edge_c[next]);
    }
    return 0.5f * sum;
}

// Fraction of a triangle that lies in a box, by their bounds.
static float fraction_inside(const float corners[3][3], const float low[3], const float high[3])
{
    float fraction = 1.0f;
    for (int axis = 0; axis < 3; axis++) {
        float from = fminf(corners[0][axis], fminf(corners[1][axis], corners[2][axis]));
        float to = fmaxf(corners[0][axis], fmaxf(corners[1][axis], corners[2][axis]));
        float inside = fminf(to, high[axis]) - fmaxf(from, low[axis]);
        if (!(inside >= 0.0f))
            return 0.0f;
        if (to > from)
            fraction *= fminf(inside / (to - from), 1.0f);
    }
    return fraction;
}

static void corner_position(const struct gpu_scene_instance *instance,
                            const struct scene_vertex *vertex, float out_position[3])
{
    const float *m = instance->world_from_local, *p = vertex->position;
    for (int row = 0; row < 3; row++)
        out_position[row] = m[row] * p[0] + m[4 + row] * p[1] + m[8 + row] * p[2] + m[12 + row];
}

struct level_bounds {
    float low[3];
    float high[3];
    float edge_m;
};

static void add_instance(const struct scene *scene, const struct gpu_scene_instance *instance,
                         const struct level_bounds *levels, uint32_t level_count, double *surfels)
{
    for (uint32_t at = 0; at < instance->index_count; at += 3) {
        float corners[3][3], edges[2][3];
        for (int i = 0; i < 3; i++)
            corner_position(
                instance,
                &scene->vertices[scene->indices[instance->index_first + at + (uint32_t)i]],
                corners[i]);
        for (int axis = 0; axis < 3; axis++) {
            edges[0][axis] = corners[1][axis] - corners[0][axis];
            edges[1][axis] = corners[2][axis] - corners[0][axis];
        }
        float area = crossings(edges[0], edges[1]);
        for (uint32_t i = 0; i < level_count && isfinite(area); i++)
            surfels[i] += area * fraction_inside(corners, levels[i].low, levels[i].high) /
                          (levels[i].edge_m * levels[i].edge_m);
    }
}

double voxel_estimate_surfels(const struct voxel_volume *volume, const struct gpu_scene *gpu_scene)
{
    struct level_bounds levels[VOXEL_MAX_LEVELS];
    double surfels[VOXEL_MAX_LEVELS] = {0.0}, sum = 0.0;
    for (uint32_t i = 0; i < volume->cell_level_count; i++) {
        const struct voxel_level *level = &volume->levels[i];
        levels[i].edge_m = (float)level->voxel_edge_m;
        for (int axis = 0; axis < 3; axis++) {
            levels[i].low[axis] =
                (float)(volume->anchor[axis] + level->box.low[axis] * level->voxel_edge_m);
            levels[i].high[axis] =
                (float)(volume->anchor[axis] + level->box.high[axis] * level->voxel_edge_m);
        }
    }
    for (uint32_t i = 0; i < gpu_scene->counts.instances; i++)
        if (gpu_scene->instances[i].visible)
            add_instance(gpu_scene->scene, &gpu_scene->instances[i], levels,
                         volume->cell_level_count, surfels);
    for (uint32_t i = 0; i < volume->cell_level_count; i++)
        sum += surfels[i];
    return sum;
}
