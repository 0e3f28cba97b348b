#include "renderer/draw_list.h"

#include <stdlib.h>
#include <string.h>

bool draw_list_reserve(struct draw_list *list, struct gpu *gpu, uint32_t instances)
{
    if (list->capacity >= instances && list->commands)
        return true;
    free(list->scratch);
    list->scratch = malloc((instances ? instances : 1) * sizeof(*list->scratch));
    list->capacity = instances;
    return list->scratch && gpu_buffer_ensure(gpu, &list->commands, "view.draws", GPU_BUFFER_STATIC,
                                              instances * sizeof(*list->scratch));
}

void draw_list_finish(struct draw_list *list)
{
    free(list->scratch);
    gpu_buffer_destroy(&list->commands);
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

void draw_list_fill(struct draw_list *list, const struct resident *resident,
                    const mat4 clip_from_world)
{
    vec4 planes[6];
    extract_planes(clip_from_world, planes);
    uint32_t total = 0;
    for (uint32_t group = 0; group < DRAW_GROUP_COUNT; group++) {
        list->first[group] = total;
        for (uint32_t i = 0; i < resident->counts.instances && total < list->capacity; i++) {
            const struct resident_instance *instance = &resident->instances[i];
            if (!instance->visible || instance->group != group ||
                box_is_outside((const vec4 *)planes, instance->bounds_min, instance->bounds_max))
                continue;
            list->scratch[total++] = (struct gpu_draw){
                .index_count = instance->index_count,
                .instance_count = 1,
                .index_first = instance->index_first,
                .base_instance = i,
            };
        }
        list->count[group] = total - list->first[group];
    }
    gpu_buffer_write(list->commands, 0, total * sizeof(*list->scratch), list->scratch);
}

void draw_list_draw(const struct draw_list *list, const struct resident *resident,
                    const struct gpu_program *program, enum draw_kind kind, bool cull_by_group)
{
    for (uint32_t cull = 0; cull < DRAW_CULL_COUNT; cull++) {
        uint32_t group = (uint32_t)kind * DRAW_CULL_COUNT + cull;
        gpu_draw_indirect(resident->gpu, program, resident->geometry, list->commands,
                          list->first[group], list->count[group],
                          cull_by_group ? (enum gpu_cull)cull : GPU_CULL_NONE);
    }
}

bool draw_list_has(const struct draw_list *list, enum draw_kind kind)
{
    uint32_t group = (uint32_t)kind * DRAW_CULL_COUNT;
    return list->count[group] + list->count[group + 1] + list->count[group + 2] > 0;
}
