// Allocates face records. A new one copies its irradiance from the next coarser level, so that a
// newly covered voxel is not black until its cones are traced.
#define CELLS_STORED
#include "lib/voxel_cells.glsl"

layout(std430, binding = BIND_VOXEL_COUNTERS) coherent buffer voxel_counter_storage
{
    uint counters[];
};

layout(std430, binding = BIND_VOXEL_FREE) coherent buffer voxel_free_storage
{
    uint free_words[]; // free cells, free surfels, returned surfels, free face records
};

uint free_faces_start()
{
    return voxels.cell_capacity + 2u * voxels.surfel_capacity;
}

// Returns the irradiance / pi / scale.
vec3 inherit_light(uint words, uint level, ivec3 voxel, uint face)
{
    if (level + 1u >= voxels.cell_level_count || !voxel_in_level(level + 1u, voxel >> 1))
        return vec3(0.0);
    uint parent = find_cell(level + 1u, voxel >> 1);
    uint from = parent == VOXEL_NONE ? VOXEL_NONE : cell_face(parent, face);
    if (from == VOXEL_NONE)
        return vec3(0.0);
    uvec4 shown = face_shown(from);
    if ((shown.w & FACE_VALID) == 0u)
        return vec3(0.0);
    uvec2 light = face_words(from, FACE_LIGHT).xy;
    faces[words + FACE_LIGHT] = light.x;
    faces[words + FACE_LIGHT + 1u] = light.y;
    faces[words + FACE_SHOWN] = shown.y;
    faces[words + FACE_SHOWN + 1u] = shown.z;
    faces[words + FACE_STATE] = FACE_VALID;
    return vec3(unpackHalf2x16(light.x), unpackHalf2x16(light.y).x);
}

// First word of the face's record, allocated if missing; VOXEL_NONE if the pool is full.
// `out_light` is its irradiance / pi / scale.
uint make_face(uint cell, uint level, ivec3 voxel, uint face, out vec3 out_light)
{
    uint words = cell_face(cell, face);
    out_light = words != VOXEL_NONE ? face_light(words).rgb : vec3(0.0);
    if (words != VOXEL_NONE)
        return words;
    uint record;
    int left = int(atomicAdd(counters[COUNTER_FREE_FACES], 0xffffffffu));
    if (left > 0)
        record = free_words[free_faces_start() + uint(left) - 1u];
    else
        record = atomicAdd(counters[COUNTER_FACES], 1u);
    if (record >= voxels.face_capacity) {
        atomicOr(counters[COUNTER_OVERFLOW], OVERFLOW_FACES);
        return VOXEL_NONE;
    }
    cells[cell * CELL_WORDS + CELL_FACES + face] = record + 1u;
    words = record * voxels.face_record_words;
    for (uint i = 0u; i < FACE_WORDS; i++)
        faces[words + i] = 0u;
    faces[words + FACE_CELL] = cell * 8u + face;
    out_light = inherit_light(words, level, voxel, face);
    return words;
}
