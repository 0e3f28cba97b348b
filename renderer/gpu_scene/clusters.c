// Bounding spheres and normal cones of runs of triangles, for culling.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "renderer/gpu_scene/gpu_scene.h"
#include "renderer/scene/scene.h"

// A cone wider than this (cosine) cannot cull anything.
#define MIN_CONE_COSINE 0.1f
#define NO_CONE         2.0f

static void bound_vertices(const struct scene *scene, const uint32_t *indices, uint32_t count,
                           vec3 out_low, vec3 out_high)
{
    glm_vec3_fill(out_low, INFINITY);
    glm_vec3_fill(out_high, -INFINITY);
    for (uint32_t i = 0; i < count; i++) {
        glm_vec3_minv(out_low, scene->vertices[indices[i]].position, out_low);
        glm_vec3_maxv(out_high, scene->vertices[indices[i]].position, out_high);
    }
}

static void bound_triangles(const struct scene *scene, const uint32_t *indices, uint32_t count,
                            struct gpu_scene_cluster *cluster)
{
    vec3 low, high;
    bound_vertices(scene, indices, count, low, high);
    glm_vec3_center(low, high, cluster->center);
    float squared = 0.0f;
    for (uint32_t i = 0; i < count; i++)
        squared = fmaxf(squared,
                        glm_vec3_distance2(cluster->center, scene->vertices[indices[i]].position));
    cluster->radius = sqrtf(squared);
}

// False for a triangle without area, which is never visible.
static bool triangle_normal(const struct scene *scene, const uint32_t indices[3], vec3 out_normal)
{
    vec3 u, v;
    glm_vec3_sub(scene->vertices[indices[1]].position, scene->vertices[indices[0]].position, u);
    glm_vec3_sub(scene->vertices[indices[2]].position, scene->vertices[indices[0]].position, v);
    glm_vec3_cross(u, v, out_normal);
    float length = glm_vec3_norm(out_normal);
    if (!(length > 0.0f) || !isfinite(length))
        return false;
    glm_vec3_scale(out_normal, 1.0f / length, out_normal);
    return true;
}

// Cone around all normals. A triangle faces away if the direction from the eye is within 90 degrees
// of its normal; for all normals of a cone of half-angle t, within 90 degrees - t of the axis:
// cutoff = cos(90 degrees - t) = sin t.
static void bound_normals(const struct scene *scene, const uint32_t *indices, uint32_t count,
                          struct gpu_scene_cluster *cluster)
{
    vec3 normal, sum = {0.0f, 0.0f, 0.0f};
    for (uint32_t i = 0; i + 2 < count; i += 3)
        if (triangle_normal(scene, indices + i, normal))
            glm_vec3_add(sum, normal, sum);
    glm_vec3_normalize_to(sum, cluster->axis);
    float narrowest = 1.0f;
    for (uint32_t i = 0; i + 2 < count; i += 3)
        if (triangle_normal(scene, indices + i, normal))
            narrowest = fminf(narrowest, glm_vec3_dot(normal, cluster->axis));
    cluster->cutoff =
        narrowest > MIN_CONE_COSINE ? sqrtf(1.0f - narrowest * narrowest) + 1e-3f : NO_CONE;
}

// Bounds of each block of a cluster.
static void bound_blocks(const struct scene *scene, const uint32_t *indices, uint32_t count,
                         struct gpu_scene_box *boxes)
{
    const uint32_t block_indices = 3u << DRAW_BLOCK_BITS;
    for (uint32_t at = 0; at < count; at += block_indices, boxes++)
        bound_vertices(scene, indices + at, count - at < block_indices ? count - at : block_indices,
                       boxes->low, boxes->high);
}

bool gpu_scene_build_clusters(struct gpu_scene *gpu_scene)
{
    const struct scene *scene = gpu_scene->scene;
    const uint32_t cluster_indices = 3u << ID_BLOCK_BITS;
    uint32_t total = 0;
    uint32_t *firsts = calloc(scene->primitive_count ? scene->primitive_count : 1, sizeof(*firsts));
    if (!firsts)
        return false;
    for (uint32_t i = 0; i < scene->primitive_count; i++) {
        firsts[i] = total;
        total += (scene->primitives[i].index_count + cluster_indices - 1) / cluster_indices;
    }
    free(gpu_scene->clusters);
    free(gpu_scene->boxes);
    gpu_scene->clusters = malloc((total ? total : 1) * sizeof(*gpu_scene->clusters));
    gpu_scene->boxes = NULL;
    bool with_boxes = gpu_get_info(gpu_scene->gpu)->software;
    if (with_boxes)
        gpu_scene->boxes =
            malloc(((size_t)(total ? total : 1) << (ID_BLOCK_BITS - DRAW_BLOCK_BITS)) *
                   sizeof(*gpu_scene->boxes));
    bool done = gpu_scene->clusters && (gpu_scene->boxes || !with_boxes);
    for (uint32_t i = 0; i < scene->primitive_count && done; i++) {
        const struct scene_primitive *primitive = &scene->primitives[i];
        for (uint32_t at = 0; at < primitive->index_count; at += cluster_indices) {
            uint32_t left = primitive->index_count - at;
            uint32_t count = left < cluster_indices ? left : cluster_indices;
            const uint32_t *indices = scene->indices + primitive->index_first + at;
            struct gpu_scene_cluster *cluster =
                &gpu_scene->clusters[firsts[i] + at / cluster_indices];
            bound_triangles(scene, indices, count, cluster);
            bound_normals(scene, indices, count, cluster);
            if (with_boxes)
                bound_blocks(scene, indices, count,
                             gpu_scene->boxes + ((size_t)(firsts[i] + at / cluster_indices)
                                                 << (ID_BLOCK_BITS - DRAW_BLOCK_BITS)));
        }
    }
    for (uint32_t i = 0; i < gpu_scene->counts.instances; i++)
        gpu_scene->instances[i].cluster_first = firsts[gpu_scene->instances[i].primitive];
    free(firsts);
    return done;
}
