// Injects the cache's bounce into occupied voxels of some levels; reuses their stored direct light.
// In: list of cells, face records. Out: radiance texture.
#include "lib/voxel_cells.glsl"

layout(std430, binding = BIND_VOXEL_COUNTERS) buffer voxel_counter_storage
{
    uint counters[];
};

#include "lib/voxel_store.glsl"

layout(local_size_x = LINEAR_GROUP) in;

layout(binding = UNIT_VOXEL_LISTS) uniform usamplerBuffer list_texels;

void main()
{
    uint number = gl_GlobalInvocationID.x;
    if (number >= counters[COUNTER_LISTS + LIST_LIT * COUNTER_LIST_WORDS + 3u])
        return;
    uint cell = texelFetch(list_texels, int(LIST_LIT * voxels.list_capacity + number)).x;
    uint word = cell_word(cell, 0u);
    uint level = word >> CELL_LEVEL_BIT;
    if (level < voxels.first_level || level >= voxels.end_level)
        return;
    face_sums sums = no_face_sums();
    uint left = cell_faces(cell);
    do {
        uint words = left == 0u ? VOXEL_NONE : cell_face(cell, uint(findLSB(left)));
        uint direction = words == VOXEL_NONE ? VOXEL_NONE : face_word(words, FACE_NORMAL);
        if (direction == VOXEL_NONE)
            continue;
        vec3 normal = octahedral_decode(unpackSnorm2x16(direction));
        uvec4 stored = face_words(words, FACE_DIRECT); // light (two words), albedo, cell
        vec4 direct = vec4(unpackHalf2x16(stored.x), unpackHalf2x16(stored.y));
        uint bits = stored.z;
        vec3 albedo = vec3(bits & 1023u, (bits >> 10) & 1023u, bits >> 20) / 1023.0;
#if MULTI_BOUNCE
        direct.rgb += albedo * face_light(words).rgb;
#endif
        add_face(sums, normal, direct);
    } while ((left &= left - 1u) != 0u);
    store_faces(sums, level, word & CELL_SLOT_MASK);
}
