// Averages each voxel face's irradiance with its neighbours in the face's plane, with weights 1 2
// 1. The cones of neighbours are rotated in a pattern of period two voxels, which these weights
// cancel. In: list of lit cells, face records. Out: the irradiance that pixels read.
#define FACES_STORED
#include "lib/voxel_cells.glsl"

layout(local_size_x = LINEAR_GROUP) in;

layout(binding = UNIT_VOXEL_LISTS) uniform usamplerBuffer list_texels;

layout(std430, binding = BIND_VOXEL_COUNTERS) readonly buffer voxel_counter_storage
{
    uint counters[];
};

void main()
{
    uint number = gl_GlobalInvocationID.x;
    if (number >= counters[COUNTER_LISTS + LIST_LIT * COUNTER_LIST_WORDS + 3u])
        return;
    uint cell = texelFetch(list_texels, int(LIST_LIT * voxels.list_capacity + number)).x;
    uint word = cell_word(cell, 0u);
    uint level = word >> CELL_LEVEL_BIT;
    ivec3 voxel = slot_voxel(level, word & CELL_SLOT_MASK);
    uint left = cell_faces(cell);
    if (left == 0u)
        return;
    do {
        uint face = uint(findLSB(left));
        uint words = cell_face(cell, face);
        uvec4 shown = face_shown(words);
        if ((shown.w & FACE_VALID) == 0u)
            continue;
        ivec3 along = ivec3(face >> 1u == 0u, face >> 1u == 1u, face >> 1u == 2u);
        vec3 normal = octahedral_decode(unpackSnorm2x16(shown.x));
        vec4 sum = 4.0 * face_light(words);
        float weight = 4.0;
        int i = 0;
        do {
            ivec2 step = ivec2(i % 3, i / 3) - 1;
            if (step == ivec2(0))
                continue;
            ivec3 at = voxel + along.zxy * step.x + along.yzx * step.y;
            uint other = voxel_in_level(level, at) ? find_cell(level, at) : VOXEL_NONE;
            uint from = other == VOXEL_NONE ? VOXEL_NONE : cell_face(other, face);
            if (from == VOXEL_NONE)
                continue;
            uvec4 its = face_shown(from);
            if ((its.w & FACE_VALID) == 0u || its.x == VOXEL_NONE)
                continue;
            vec3 its_normal = octahedral_decode(unpackSnorm2x16(its.x));
            float fraction = (step.x == 0 || step.y == 0 ? 2.0 : 1.0) *
                             smoothstep(0.7, 0.95, dot(normal, its_normal));
            sum += fraction * face_light(from);
            weight += fraction;
        } while (++i < 9);
        sum /= weight;
        sum.a = max(sum.a, 0.001); // 0 means unknown
        faces[words + FACE_SHOWN] = packHalf2x16(sum.xy);
        faces[words + FACE_SHOWN + 1u] = packHalf2x16(sum.zw);
    } while ((left &= left - 1u) != 0u);
}
