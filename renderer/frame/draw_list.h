// Indirect draws of the triangles visible to a camera or light, grouped by kind and culling mode.
#ifndef VOXCAST_RENDERER_FRAME_DRAW_LIST_H
#define VOXCAST_RENDERER_FRAME_DRAW_LIST_H

#include "renderer/gpu_scene/gpu_scene.h"

struct draw_list {
    struct gpu_buffer *commands;
    struct gpu_buffer *records;
    struct gpu_draw *scratch_commands;
    struct gpu_draw_record *scratch_records;
    uint32_t capacity;
    // Of lists that were filled by blocks: triangles in a row, and what draws them.
    struct gpu_buffer *indices;
    struct gpu_geometry *geometry;
    uint32_t *scratch_indices;
    uint32_t index_capacity;
    uint32_t first[DRAW_GROUP_COUNT];
    uint32_t count[DRAW_GROUP_COUNT];
};

// Reserves space for the draws of `gpu_scene`. False when memory runs out.
bool draw_list_reserve(struct draw_list *list, const struct gpu_scene *gpu_scene);
void draw_list_finish(struct draw_list *list);

// Fills the list with the clusters of visible instances that overlap the clip volume -w <= x, y <=
// w, 0 <= z <= w. With an `eye` (world), also skips clusters of which it sees only back faces of
// single-sided triangles. Cost: linear in the clusters near the volume.
void draw_list_fill(struct draw_list *list, const struct gpu_scene *gpu_scene,
                    const mat4 clip_from_world, const float *eye);

// 2^DRAW_BLOCK_BITS triangles of an instance, or what is left of it.
struct draw_block {
    uint32_t number; // of all blocks: (visibility id - 1) >> DRAW_BLOCK_BITS
    const struct gpu_scene_box *box;
    const float (*clip_rows)[4]; // of clip_from_local
};

struct draw_filter {
    bool (*admits)(const void *user, const struct draw_block *block);
    const void *user;
};

// Likewise, but with those blocks alone that the filter admits, of opaque and masked triangles. For
// CPU drivers, where triangles are dear: copies the indices, so that an instance is one draw. False
// when memory runs out.
bool draw_list_fill_blocks(struct draw_list *list, const struct gpu_scene *gpu_scene,
                           const mat4 clip_from_world, const float *eye,
                           const struct draw_filter *filter);

// Triangles of opaque and masked draws.
uint32_t draw_list_opaque_triangles(const struct draw_list *list);

// Draws the groups of one kind. With `cull_by_group` false, draws both sides of all triangles.
void draw_list_draw(const struct draw_list *list, const struct gpu_scene *gpu_scene,
                    const struct gpu_program *program, enum draw_kind kind, bool cull_by_group);

bool draw_list_has(const struct draw_list *list, enum draw_kind kind);

#endif
