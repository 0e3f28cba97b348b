// Clears regions: frees their cells and surfels, and blackens their texels. In: regions. Out:
// index, cells, radiance texture, free lists.
#define CELLS_STORED
#include "lib/voxel_work.glsl"
#include "lib/voxel_texture.glsl"

layout(local_size_x = LINEAR_GROUP) in;

layout(binding = UNIT_SURFELS) uniform usamplerBuffer surfels;

// Clears mip voxels whose last occupied voxel was removed: filtering only visits occupied ones.
void clear_mips(uint level, ivec3 voxel)
{
    if (level + 1u != voxels.cell_level_count)
        return;
    for (uint mip = level + 1u; mip < voxels.level_count; mip++) {
        ivec3 address = slot_address(mip, voxel_slot(mip, voxel >> int(mip - level)));
        for (uint face = 0u; face < voxels.face_count; face++)
            store_voxel_face(mip, address, face, vec4(0.0));
    }
}

void clear_voxel(uint number)
{
    uint level;
    ivec3 voxel;
    region_voxel(number, level, voxel);
    uint slot = voxel_slot(level, voxel);
    uint cell = index_word(voxels.levels[level].first_index + slot) - 1u;
    uint surfel = cell_word(cell, CELL_SURFEL);
    while (surfel != VOXEL_NONE) {
        free_words[voxels.cell_capacity + atomicAdd(counters[COUNTER_FREE_SURFELS], 1u)] = surfel;
        surfel = texelFetch(surfels, int(surfel * SURFEL_WORDS + SURFEL_NEXT)).x;
    }
    for (uint face = 0u; face < VOXEL_FACES; face++) {
        uint record = cell_word(cell, CELL_FACES + face);
        if (record != 0u)
            free_words[voxels.cell_capacity + 2u * voxels.surfel_capacity +
                       atomicAdd(counters[COUNTER_FREE_FACES], 1u)] = record - 1u;
    }
    cells[cell * CELL_WORDS] = VOXEL_NONE;
    free_words[atomicAdd(counters[COUNTER_FREE_CELLS], 1u)] = cell;
    voxel_index[voxels.levels[level].first_index + slot] = 0u;
    ivec3 address = slot_address(level, slot);
    for (uint face = 0u; face < voxels.face_count; face++)
        store_voxel_face(level, address, face, vec4(0.0));
    clear_mips(level, voxel);
}

void main()
{
    uint run = region_invocation();
    FIND_OCCUPIED(run, occupied)
    for (; occupied != 0u; occupied &= occupied - 1u)
        clear_voxel(run * REGION_RUN + uint(findLSB(occupied)));
}
