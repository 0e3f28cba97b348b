// Averages each voxel face's irradiance with its neighbours in the face's plane, with weights 1 2
// 1. The cones of neighbours are rotated in a pattern of period two voxels, which these weights
// cancel. In: list of lit cells, face records. Out: the irradiance that pixels read.
#include "lib/voxel_cells.glsl"

layout(local_size_x = LINEAR_GROUP) in;

layout(std430, binding = BIND_VOXEL_LISTS) readonly buffer voxel_list_storage
{
    uint list_words[];
};

layout(std430, binding = BIND_VOXEL_COUNTERS) readonly buffer voxel_counter_storage
{
    uint counters[];
};

void main()
{
    uint number = gl_GlobalInvocationID.x;
    if (number >= counters[COUNTER_LISTS + LIST_LIT * COUNTER_LIST_WORDS + 3u])
        return;
    uint cell = list_words[LIST_LIT * voxels.list_capacity + number];
    uint level = cells[cell * CELL_WORDS] >> CELL_LEVEL_BIT;
    ivec3 voxel = slot_voxel(level, cells[cell * CELL_WORDS] & CELL_SLOT_MASK);
    for (uint face = 0u; face < VOXEL_FACES; face++) {
        uint words = cell_face(cell, face);
        if (words == VOXEL_NONE || (faces[words + FACE_STATE] & FACE_VALID) == 0u)
            continue;
        ivec3 along = ivec3(face >> 1u == 0u, face >> 1u == 1u, face >> 1u == 2u);
        vec3 normal = octahedral_decode(unpackSnorm2x16(faces[words + FACE_NORMAL]));
        vec4 sum = 4.0 * face_light(words);
        float weight = 4.0;
        for (int i = 0; i < 9; i++) {
            ivec2 step = ivec2(i % 3, i / 3) - 1;
            if (step == ivec2(0))
                continue;
            ivec3 at = voxel + along.zxy * step.x + along.yzx * step.y;
            uint other = voxel_in_level(level, at) ? find_cell(level, at) : VOXEL_NONE;
            uint from = other == VOXEL_NONE ? VOXEL_NONE : cell_face(other, face);
            if (from == VOXEL_NONE || (faces[from + FACE_STATE] & FACE_VALID) == 0u ||
                faces[from + FACE_NORMAL] == VOXEL_NONE)
                continue;
            vec3 its = octahedral_decode(unpackSnorm2x16(faces[from + FACE_NORMAL]));
            float fraction =
                (step.x == 0 || step.y == 0 ? 2.0 : 1.0) * smoothstep(0.7, 0.95, dot(normal, its));
            sum += fraction * face_light(from);
            weight += fraction;
        }
        sum /= weight;
        sum.a = max(sum.a, 0.001); // 0 means unknown
        faces[words + FACE_SHOWN] = packHalf2x16(sum.xy);
        faces[words + FACE_SHOWN + 1u] = packHalf2x16(sum.zw);
    }
}
