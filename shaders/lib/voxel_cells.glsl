// The index from voxels to cells, and the cells. CELLS_ACCESS: readonly where a pass only reads.
#include "lib/voxel.glsl"

#ifndef CELLS_ACCESS
#define CELLS_ACCESS
#endif

layout(std430, binding = BIND_VOXEL_INDEX) CELLS_ACCESS buffer voxel_index_storage
{
    uint voxel_index[];
};

layout(std430, binding = BIND_CELLS) CELLS_ACCESS buffer cell_storage
{
    uint cells[]; // CELL_WORDS each
};

uint cell_face(uint cell, uint face)
{
    return cell * CELL_WORDS + CELL_FACES + face * CELL_FACE_WORDS;
}

// The cell of a voxel of the level, or VOXEL_NONE.
uint find_cell(uint level, ivec3 voxel)
{
    uint entry = voxel_index[voxels.levels[level].index.x + voxel_slot(level, voxel)];
    return entry - 1u; // empty: 0 - 1 = VOXEL_NONE
}
