// The scene's small tables in one GPU buffer, of which shaders fetch texels of four words: one
// texture unit for all, of the 32 that a shader has.
#ifndef VOXCAST_RENDERER_GPU_SCENE_SCENE_TABLES_H
#define VOXCAST_RENDERER_GPU_SCENE_SCENE_TABLES_H

#include "renderer/gpu/buffer.h"

enum scene_table {
    TABLE_INSTANCES,   // struct instance_block
    TABLE_ID_BLOCKS,   // instance of each block of visibility ids, one word each
    TABLE_MATERIALS,   // struct material_block
    TABLE_TEXTURES,    // struct texture_block
    TABLE_LIGHTS,      // struct light_block
    TABLE_AREA_LIGHTS, // struct area_light_block
    TABLE_ENVIRONMENT, // struct environment_block
    SCENE_TABLE_COUNT
};

struct scene_tables {
    struct gpu *gpu;
    struct gpu_buffer *buffer;
    uint32_t first[SCENE_TABLE_COUNT];    // texel
    uint32_t capacity[SCENE_TABLE_COUNT]; // texels
    size_t size_bytes[SCENE_TABLE_COUNT]; // in use
};

// Replaces a table. False when memory runs out.
bool scene_tables_write(struct scene_tables *tables, enum scene_table table, const void *data,
                        size_t size_bytes);
void scene_tables_finish(struct scene_tables *tables);

#endif
