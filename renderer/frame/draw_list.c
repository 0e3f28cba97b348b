#include "renderer/frame/draw_list.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "renderer/scene/scene.h"

bool draw_list_reserve(struct draw_list *list, const struct gpu_scene *gpu_scene)
{
    uint32_t wanted = gpu_scene->cluster_count ? gpu_scene->cluster_count : 1;
    if (list->capacity >= wanted)
        return true;
    draw_list_finish(list);
    list->scratch_commands = malloc(wanted * sizeof(*list->scratch_commands));
    list->scratch_records = malloc(wanted * sizeof(*list->scratch_records));
    if (!list->scratch_commands || !list->scratch_records ||
        !gpu_buffer_ensure(gpu_scene->gpu, &list->commands, "view_targets.draws", GPU_BUFFER_STATIC,
                           wanted * sizeof(*list->scratch_commands)) ||
        !gpu_buffer_ensure(gpu_scene->gpu, &list->records, "view_targets.draws", GPU_BUFFER_STATIC,
                           wanted * sizeof(*list->scratch_records)))
        return false;
    list->capacity = wanted;
    return true;
}

void draw_list_finish(struct draw_list *list)
{
    free(list->scratch_commands);
    free(list->scratch_records);
    free(list->scratch_indices);
    gpu_geometry_destroy(&list->geometry);
    gpu_buffer_destroy(&list->indices);
    gpu_buffer_destroy(&list->commands);
    gpu_buffer_destroy(&list->records);
    *list = (struct draw_list){0};
}

// Planes of the clip volume in world space: inside where dot(plane, (p, 1)) >= 0.
static void extract_planes(const mat4 m, vec4 out_planes[6])
{
    for (int i = 0; i < 4; i++) {
        float x = m[i][0], y = m[i][1], z = m[i][2], w = m[i][3];
        out_planes[0][i] = w + x;
        out_planes[1][i] = w - x;
        out_planes[2][i] = w + y;
        out_planes[3][i] = w - y;
        out_planes[4][i] = w - z;
        out_planes[5][i] = z;
    }
}

static bool box_is_outside(const vec4 planes[6], const float low[3], const float high[3])
{
    for (int i = 0; i < 6; i++) {
        float farthest = planes[i][3];
        for (int axis = 0; axis < 3; axis++)
            farthest += planes[i][axis] * (planes[i][axis] > 0.0f ? high[axis] : low[axis]);
        if (farthest < 0.0f)
            return true;
    }
    return false;
}

static bool sphere_is_outside(const vec4 planes[6], const float center[3], float radius)
{
    for (int i = 0; i < 6; i++) {
        float distance = planes[i][3];
        for (int axis = 0; axis < 3; axis++)
            distance += planes[i][axis] * center[axis];
        if (distance < -radius * glm_vec3_norm((float *)planes[i]))
            return true;
    }
    return false;
}

// Culling data of one instance: what is constant over its clusters.
struct instance_cull {
    const vec4 *planes;
    float clip_rows[4][4]; // of clip_from_local
    float matrix[16];
    float scale;
    bool by_cone;
    vec3 eye_local;
};

static void instance_cull_init(struct instance_cull *cull,
                               const struct gpu_scene_instance *instance, const vec4 planes[6],
                               const mat4 clip_from_world, const float *eye)
{
    cull->planes = planes;
    const float *m = instance->world_from_local;
    // In double: far from the origin the products nearly cancel.
    for (int row = 0; row < 4; row++)
        for (int column = 0; column < 4; column++) {
            double sum = 0.0;
            for (int i = 0; i < 4; i++)
                sum += (double)clip_from_world[i][row] * m[column * 4 + i];
            cull->clip_rows[row][column] = (float)sum;
        }
    memcpy(cull->matrix, instance->world_from_local, sizeof(cull->matrix));
    cull->scale = instance->scale;
    mat4 world_from_local, local_from_world;
    memcpy(world_from_local, cull->matrix, sizeof(cull->matrix));
    float determinant = glm_mat4_det(world_from_local);
    cull->by_cone = eye && instance->group % DRAW_CULL_COUNT != GPU_CULL_NONE &&
                    fabsf(determinant) > 1e-20f && isfinite(determinant);
    if (cull->by_cone) {
        glm_mat4_inv(world_from_local, local_from_world);
        glm_mat4_mulv3(local_from_world, (float *)eye, 1.0f, cull->eye_local);
    }
}

// Affine transforms keep the sides of planes, so facing is tested in local space.
static bool cluster_is_hidden(const struct instance_cull *cull,
                              const struct gpu_scene_cluster *cluster)
{
    const float *m = cull->matrix, *c = cluster->center;
    vec3 center;
    for (int row = 0; row < 3; row++)
        center[row] = m[row] * c[0] + m[4 + row] * c[1] + m[8 + row] * c[2] + m[12 + row];
    if (sphere_is_outside(cull->planes, center, cluster->radius * cull->scale))
        return true;
    if (!cull->by_cone || cluster->cutoff > 1.0f)
        return false;
    vec3 from_eye;
    glm_vec3_sub((float *)cluster->center, (float *)cull->eye_local, from_eye);
    return glm_vec3_dot(from_eye, (float *)cluster->axis) >=
           cluster->cutoff * glm_vec3_norm(from_eye) + cluster->radius;
}

// Appends one draw of an instance.
static void append_draw(struct draw_list *list, uint32_t *total, const struct gpu_scene *gpu_scene,
                        const struct gpu_scene_instance *instance, const struct instance_cull *cull,
                        uint32_t index_first, uint32_t index_count)
{
    list->scratch_commands[*total] = (struct gpu_draw){
        .index_count = index_count,
        .instance_count = 1,
        .index_first = index_first,
        .base_instance = *total,
    };
    struct gpu_draw_record *record = &list->scratch_records[*total];
    memcpy(record->clip_rows, cull->clip_rows, sizeof(record->clip_rows));
    record->first_id = instance->first_id + 1;
    record->material = gpu_scene->scene->primitives[instance->primitive].material;
    (*total)++;
}

static void append_instance(struct draw_list *list, uint32_t *total,
                            const struct gpu_scene *gpu_scene, uint32_t instance_number,
                            const struct instance_cull *cull)
{
    const struct gpu_scene_instance *instance = &gpu_scene->instances[instance_number];
    const uint32_t cluster_triangles = 1u << ID_BLOCK_BITS;
    uint32_t triangles = instance->index_count / 3;
    uint32_t run_first = 0, run_count = 0;
    for (uint32_t at = 0; at < triangles; at += cluster_triangles) {
        uint32_t left = triangles - at;
        uint32_t count = left < cluster_triangles ? left : cluster_triangles;
        const struct gpu_scene_cluster *cluster =
            &gpu_scene->clusters[instance->cluster_first + (at >> ID_BLOCK_BITS)];
        if (!cluster_is_hidden(cull, cluster)) {
            if (run_count == 0)
                run_first = at;
            run_count += count;
        } else if (run_count > 0) {
            append_draw(list, total, gpu_scene, instance, cull,
                        instance->index_first + 3 * run_first, 3 * run_count);
            run_count = 0;
        }
    }
    if (run_count > 0)
        append_draw(list, total, gpu_scene, instance, cull, instance->index_first + 3 * run_first,
                    3 * run_count);
}

static bool reserve_indices(struct draw_list *list, uint32_t wanted)
{
    if (list->index_capacity >= wanted)
        return true;
    uint32_t capacity = wanted + wanted / 2;
    uint32_t *grown = realloc(list->scratch_indices, capacity * sizeof(*grown));
    if (!grown)
        return false;
    list->scratch_indices = grown;
    list->index_capacity = capacity;
    return true;
}

// Copies the indices of an instance's blocks that the filter admits, and appends a draw of them.
static bool append_blocks(struct draw_list *list, uint32_t *total, uint32_t *index_total,
                          const struct gpu_scene *gpu_scene, uint32_t instance_number,
                          const struct instance_cull *cull, const struct draw_filter *filter)
{
    const struct gpu_scene_instance *instance = &gpu_scene->instances[instance_number];
    const uint32_t *indices = gpu_buffer_mapping(gpu_scene->raster_indices);
    const uint32_t block_count = ((instance->index_count / 3 - 1) >> DRAW_BLOCK_BITS) + 1;
    const uint32_t blocks_log2 = ID_BLOCK_BITS - DRAW_BLOCK_BITS; // in a cluster
    uint32_t first = *index_total;
    bool hidden = false;
    for (uint32_t i = 0; i < block_count; i++) {
        if ((i & ((1u << blocks_log2) - 1u)) == 0)
            hidden = cluster_is_hidden(
                cull, &gpu_scene->clusters[instance->cluster_first + (i >> blocks_log2)]);
        struct draw_block block = {
            .number = (instance->first_id >> DRAW_BLOCK_BITS) + i,
            .box = &gpu_scene->boxes[((size_t)instance->cluster_first << blocks_log2) + i],
            .clip_rows = cull->clip_rows,
        };
        if (hidden || !filter->admits(filter->user, &block))
            continue;
        uint32_t at = i * (3u << DRAW_BLOCK_BITS);
        uint32_t left = instance->index_count - at;
        uint32_t count = left < (3u << DRAW_BLOCK_BITS) ? left : 3u << DRAW_BLOCK_BITS;
        if (!reserve_indices(list, *index_total + count))
            return false;
        memcpy(list->scratch_indices + *index_total, indices + instance->index_first + at,
               count * sizeof(*indices));
        *index_total += count;
    }
    if (*index_total > first)
        append_draw(list, total, gpu_scene, instance, cull, first, *index_total - first);
    return true;
}

// Lists all groups up to `end`, by blocks if there is a filter.
static bool list_groups(struct draw_list *list, const struct gpu_scene *gpu_scene,
                        const mat4 clip_from_world, const float *eye, uint32_t end,
                        const struct draw_filter *filter, uint32_t *out_index_total)
{
    vec4 planes[6];
    extract_planes(clip_from_world, planes);
    uint32_t total = 0;
    *out_index_total = 0;
    memset(list->count, 0, sizeof(list->count));
    for (uint32_t group = 0; group < end; group++) {
        list->first[group] = total;
        for (uint32_t i = 0; i < gpu_scene->counts.instances; i++) {
            const struct gpu_scene_instance *instance = &gpu_scene->instances[i];
            if (!instance->visible || instance->group != group || instance->index_count < 3 ||
                box_is_outside((const vec4 *)planes, instance->bounds_min, instance->bounds_max))
                continue;
            struct instance_cull cull;
            instance_cull_init(&cull, instance, (const vec4 *)planes, clip_from_world, eye);
            if (!filter)
                append_instance(list, &total, gpu_scene, i, &cull);
            else if (!append_blocks(list, &total, out_index_total, gpu_scene, i, &cull, filter))
                return false;
        }
        list->count[group] = total - list->first[group];
    }
    gpu_buffer_write(list->commands, 0, total * sizeof(*list->scratch_commands),
                     list->scratch_commands);
    gpu_buffer_write(list->records, 0, total * sizeof(*list->scratch_records),
                     list->scratch_records);
    return true;
}

void draw_list_fill(struct draw_list *list, const struct gpu_scene *gpu_scene,
                    const mat4 clip_from_world, const float *eye)
{
    uint32_t no_indices;
    list_groups(list, gpu_scene, clip_from_world, eye, DRAW_GROUP_COUNT, NULL, &no_indices);
}

bool draw_list_fill_blocks(struct draw_list *list, const struct gpu_scene *gpu_scene,
                           const mat4 clip_from_world, const float *eye,
                           const struct draw_filter *filter)
{
    uint32_t count;
    if (!draw_list_reserve(list, gpu_scene) ||
        !list_groups(list, gpu_scene, clip_from_world, eye, DRAW_TRANSPARENT * DRAW_CULL_COUNT,
                     filter, &count))
        return false;
    gpu_geometry_destroy(&list->geometry);
    if (count == 0)
        return true;
    if (!gpu_buffer_ensure(gpu_scene->gpu, &list->indices, "view_targets.draws", GPU_BUFFER_STATIC,
                           list->index_capacity * sizeof(*list->scratch_indices)))
        return false;
    gpu_buffer_write(list->indices, 0, count * sizeof(*list->scratch_indices),
                     list->scratch_indices);
    list->geometry = gpu_geometry_create(gpu_scene->gpu, gpu_scene->raster_vertices, list->indices);
    return list->geometry != NULL;
}

uint32_t draw_list_opaque_triangles(const struct draw_list *list)
{
    uint32_t indices = 0;
    for (uint32_t group = 0; group < DRAW_TRANSPARENT * DRAW_CULL_COUNT; group++)
        for (uint32_t i = 0; i < list->count[group]; i++)
            indices += list->scratch_commands[list->first[group] + i].index_count;
    return indices / 3;
}

void draw_list_draw(const struct draw_list *list, const struct gpu_scene *gpu_scene,
                    const struct gpu_program *program, enum draw_kind kind, bool cull_by_group)
{
    for (uint32_t cull = 0; cull < DRAW_CULL_COUNT; cull++) {
        uint32_t group = (uint32_t)kind * DRAW_CULL_COUNT + cull;
        gpu_draw_indirect(gpu_scene->gpu,
                          &(struct gpu_draw_params){
                              .program = program,
                              .geometry = list->geometry ? list->geometry : gpu_scene->geometry,
                              .draws = list->commands,
                              .records = list->records,
                              .first = list->first[group],
                              .count = list->count[group],
                              .cull = cull_by_group ? (enum gpu_cull)cull : GPU_CULL_NONE,
                          });
    }
}

bool draw_list_has(const struct draw_list *list, enum draw_kind kind)
{
    uint32_t group = (uint32_t)kind * DRAW_CULL_COUNT;
    return list->count[group] + list->count[group + 1] + list->count[group + 2] > 0;
}
