#include "renderer/gpu_scene/scene_tables.h"

#define TEXEL_BYTES 16u

// Lays the tables out anew with room for `texels` in one of them, and keeps what they hold.
static bool make_room(struct scene_tables *tables, enum scene_table table, uint64_t texels)
{
    struct scene_tables grown = *tables;
    uint64_t total = 0;
    // Half as much again, so that a table that grows step by step is seldom laid out.
    uint64_t roomy = texels + texels / 2;
    for (int i = 0; i < SCENE_TABLE_COUNT; i++) {
        uint64_t capacity = i == (int)table ? roomy : tables->capacity[i];
        if (capacity > UINT32_MAX || total > UINT32_MAX - capacity)
            return false;
        grown.first[i] = (uint32_t)total;
        grown.capacity[i] = (uint32_t)capacity;
        total += capacity;
    }
    if (!gpu_texels_fit(tables->gpu, GPU_TEXEL_UINT4, total * TEXEL_BYTES))
        return false;
    grown.buffer = gpu_buffer_create(tables->gpu, "scene_tables", GPU_BUFFER_STATIC,
                                     total * TEXEL_BYTES, NULL);
    if (!grown.buffer)
        return false;
    for (int i = 0; i < SCENE_TABLE_COUNT; i++)
        if (i != (int)table && tables->size_bytes[i] > 0)
            gpu_buffer_copy(grown.buffer, (size_t)grown.first[i] * TEXEL_BYTES, tables->buffer,
                            (size_t)tables->first[i] * TEXEL_BYTES, tables->size_bytes[i]);
    gpu_buffer_destroy(&tables->buffer);
    *tables = grown;
    return true;
}

bool scene_tables_write(struct scene_tables *tables, enum scene_table table, const void *data,
                        size_t size_bytes)
{
    uint64_t texels = (size_bytes + TEXEL_BYTES - 1) / TEXEL_BYTES;
    if ((texels > tables->capacity[table] || !tables->buffer) &&
        !make_room(tables, table, texels > 0 ? texels : 1))
        return false;
    tables->size_bytes[table] = size_bytes;
    gpu_buffer_write(tables->buffer, (size_t)tables->first[table] * TEXEL_BYTES, size_bytes, data);
    return true;
}

void scene_tables_finish(struct scene_tables *tables)
{
    gpu_buffer_destroy(&tables->buffer);
}
