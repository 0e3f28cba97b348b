// Indirect draws of the instances that a camera or lamp can see, grouped by kind and culling.
#ifndef VOXCAST_RENDERER_DRAW_LIST_H
#define VOXCAST_RENDERER_DRAW_LIST_H

#include "renderer/resident/resident.h"

struct draw_list {
    struct gpu_buffer *commands;
    struct gpu_draw *scratch;
    uint32_t capacity;
    uint32_t first[DRAW_GROUP_COUNT];
    uint32_t count[DRAW_GROUP_COUNT];
};

// False when memory ends.
bool draw_list_reserve(struct draw_list *list, struct gpu *gpu, uint32_t instances);
void draw_list_finish(struct draw_list *list);

// Fills the list with the visible instances whose boxes reach into the clip volume -w <= x, y <= w,
// 0 <= z <= w. Cost: linear in instances.
void draw_list_fill(struct draw_list *list, const struct resident *resident,
                    const mat4 clip_from_world);

// Draws the groups of one kind. `cull_by_group` false draws both sides of all triangles.
void draw_list_draw(const struct draw_list *list, const struct resident *resident,
                    const struct gpu_program *program, enum draw_kind kind, bool cull_by_group);

bool draw_list_has(const struct draw_list *list, enum draw_kind kind);

#endif
