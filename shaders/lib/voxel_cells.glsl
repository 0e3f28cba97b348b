// The index from voxels to cells, the cells and their face records. Reads see what earlier
// dispatches have written. FACES_STORED, CELLS_STORED: defined by shaders that write face records,
// or all.
#include "lib/voxel.glsl"

layout(binding = UNIT_VOXEL_INDEX) uniform usamplerBuffer index_texels;
layout(binding = UNIT_CELLS) uniform usamplerBuffer cell_texels; // CELL_WORDS words each
layout(binding = UNIT_FACES) uniform usamplerBuffer face_texels; // voxels.face_record_words words

#ifdef CELLS_STORED
#define FACES_STORED
layout(std430, binding = BIND_VOXEL_INDEX) writeonly buffer voxel_index_storage
{
    uint voxel_index[];
};

layout(std430, binding = BIND_CELLS) writeonly buffer cell_storage
{
    uint cells[];
};
#endif

#ifdef FACES_STORED
layout(std430, binding = BIND_FACES) writeonly buffer face_storage
{
    uint faces[];
};
#endif

uint index_word(uint index)
{
    return texelFetch(index_texels, int(index)).x;
}

// Four words of a cell from word `first`.
uvec4 cell_words(uint cell, uint first)
{
    return texelFetch(cell_texels, int((cell * CELL_WORDS + first) >> 2));
}

uint cell_word(uint cell, uint word)
{
    return cell_words(cell, word)[word & 3u];
}

// Four words of a face record, which begins at word `words`.
uvec4 face_words(uint words, uint first)
{
    return texelFetch(face_texels, int((words + first) >> 2));
}

uint face_word(uint words, uint word)
{
    return face_words(words, word)[word & 3u];
}

// The faces that a cell has a record of, a bit each.
uint cell_faces(uint cell)
{
    uvec2 x = cell_words(cell, 0u).zw; // from word CELL_FACES on
    uvec4 yz = cell_words(cell, 4u);
    return (x.x != 0u ? 1u : 0u) | (x.y != 0u ? 2u : 0u) | (yz.x != 0u ? 4u : 0u) |
           (yz.y != 0u ? 8u : 0u) | (yz.z != 0u ? 16u : 0u) | (yz.w != 0u ? 32u : 0u);
}

// First word of a cell's face record; VOXEL_NONE if it has none.
uint cell_face(uint cell, uint face)
{
    uint record = cell_word(cell, CELL_FACES + face);
    return record == 0u ? VOXEL_NONE : (record - 1u) * voxels.face_record_words;
}

// Irradiance / pi / scale and ambient visibility.
vec4 face_light(uint words)
{
    uvec2 light = face_words(words, FACE_LIGHT).xy;
    return vec4(unpackHalf2x16(light.x), unpackHalf2x16(light.y));
}

// Normal, smoothed irradiance (two words) and state.
uvec4 face_shown(uint words)
{
    return face_words(words, FACE_NORMAL);
}

// The irradiance as pixels read it: smoothed over neighbours, which trace different directions.
vec4 face_shown_light(uvec4 shown)
{
    return vec4(unpackHalf2x16(shown.y), unpackHalf2x16(shown.z));
}

// The cell of a voxel of the level, or VOXEL_NONE.
uint find_cell(uint level, ivec3 voxel)
{
    uint entry = index_word(voxels.levels[level].first_index + voxel_slot(level, voxel));
    return entry - 1u; // empty: 0 - 1 = VOXEL_NONE
}
