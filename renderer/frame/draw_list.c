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

// Appends one draw: triangles first to first + count - 1 of an instance.
static void append_draw(struct draw_list *list, uint32_t *total, const struct gpu_scene *gpu_scene,
                        const struct gpu_scene_instance *instance, const struct instance_cull *cull,
                        uint32_t first, uint32_t count)
{
    list->scratch_commands[*total] = (struct gpu_draw){
        .index_count = 3 * count,
        .instance_count = 1,
        .index_first = instance->index_first + 3 * first,
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
            append_draw(list, total, gpu_scene, instance, cull, run_first, run_count);
            run_count = 0;
        }
    }
    if (run_count > 0)
        append_draw(list, total, gpu_scene, instance, cull, run_first, run_count);
}

void draw_list_fill(struct draw_list *list, const struct gpu_scene *gpu_scene,
                    const mat4 clip_from_world, const float *eye)
{
    vec4 planes[6];
    extract_planes(clip_from_world, planes);
    uint32_t total = 0;
    for (uint32_t group = 0; group < DRAW_GROUP_COUNT; group++) {
        list->first[group] = total;
        for (uint32_t i = 0; i < gpu_scene->counts.instances; i++) {
            const struct gpu_scene_instance *instance = &gpu_scene->instances[i];
            if (!instance->visible || instance->group != group ||
                box_is_outside((const vec4 *)planes, instance->bounds_min, instance->bounds_max))
                continue;
            struct instance_cull cull;
            instance_cull_init(&cull, instance, (const vec4 *)planes, clip_from_world, eye);
            append_instance(list, &total, gpu_scene, i, &cull);
        }
        list->count[group] = total - list->first[group];
    }
    gpu_buffer_write(list->commands, 0, total * sizeof(*list->scratch_commands),
                     list->scratch_commands);
    gpu_buffer_write(list->records, 0, total * sizeof(*list->scratch_records),
                     list->scratch_records);
}

void draw_list_draw(const struct draw_list *list, const struct gpu_scene *gpu_scene,
                    const struct gpu_program *program, enum draw_kind kind, bool cull_by_group)
{
    for (uint32_t cull = 0; cull < DRAW_CULL_COUNT; cull++) {
        uint32_t group = (uint32_t)kind * DRAW_CULL_COUNT + cull;
        gpu_draw_indirect(gpu_scene->gpu,
                          &(struct gpu_draw_params){
                              .program = program,
                              .geometry = gpu_scene->geometry,
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
