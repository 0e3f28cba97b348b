// Injects the cache's bounce into occupied voxels of some levels; reuses their stored direct light.
// In: list of cells, face records. Out: radiance texture.
#define CELLS_ACCESS readonly
#include "lib/voxel_cells.glsl"

layout(std430, binding = BIND_VOXEL_COUNTERS) buffer voxel_counter_storage
{
    uint counters[];
};

#include "lib/voxel_store.glsl"

layout(local_size_x = LINEAR_GROUP) in;

layout(std430, binding = BIND_VOXEL_LISTS) readonly buffer voxel_list_storage
{
    uint list_words[];
};

void main()
{
    uint number = gl_GlobalInvocationID.x;
    if (number >= counters[COUNTER_LISTS + LIST_LIT * COUNTER_LIST_WORDS + 3u])
        return;
    uint cell = list_words[LIST_LIT * voxels.list_capacity + number];
    uint word = cells[cell * CELL_WORDS];
    uint level = word >> CELL_LEVEL_BIT;
    if (level < voxels.first_level || level >= voxels.end_level)
        return;
    face_sums sums = no_face_sums();
    for (uint i = 0u; i < VOXEL_FACES; i++) {
        uint words = cell_face(cell, i);
        if (words == VOXEL_NONE || faces[words + FACE_NORMAL] == VOXEL_NONE)
            continue;
        vec3 normal = octahedral_decode(unpackSnorm2x16(faces[words + FACE_NORMAL]));
        vec4 direct = vec4(unpackHalf2x16(faces[words + FACE_DIRECT]),
                           unpackHalf2x16(faces[words + FACE_DIRECT + 1u]));
        uint bits = faces[words + FACE_ALBEDO];
        vec3 albedo = vec3(bits & 1023u, (bits >> 10) & 1023u, bits >> 20) / 1023.0;
#if MULTI_BOUNCE
        direct.rgb += albedo * face_light(words).rgb;
#endif
        add_face(sums, normal, direct);
    }
    store_faces(sums, level, word & CELL_SLOT_MASK);
}
