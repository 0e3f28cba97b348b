// The index from voxels to cells, and the cells. CELLS_ACCESS: readonly in passes that only read.
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

layout(std430, binding = BIND_FACES) CELLS_ACCESS buffer face_storage
{
    uint faces[]; // voxels.face_record_words words each
};

// First word of a cell's face record; VOXEL_NONE if it has none.
uint cell_face(uint cell, uint face)
{
    uint record = cells[cell * CELL_WORDS + CELL_FACES + face];
    return record == 0u ? VOXEL_NONE : (record - 1u) * voxels.face_record_words;
}

// Irradiance / pi / scale and ambient visibility.
vec4 face_light(uint words)
{
    return vec4(unpackHalf2x16(faces[words + FACE_LIGHT]),
                unpackHalf2x16(faces[words + FACE_LIGHT + 1u]));
}

// The same as pixels read it: smoothed over neighbours, which trace different directions.
vec4 face_shown_light(uint words)
{
    return vec4(unpackHalf2x16(faces[words + FACE_SHOWN]),
                unpackHalf2x16(faces[words + FACE_SHOWN + 1u]));
}

// The cell of a voxel of the level, or VOXEL_NONE.
uint find_cell(uint level, ivec3 voxel)
{
    uint entry = voxel_index[voxels.levels[level].first_index + voxel_slot(level, voxel)];
    return entry - 1u; // empty: 0 - 1 = VOXEL_NONE
}
