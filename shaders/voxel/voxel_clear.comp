// Clears regions: frees their cells and surfels, and blackens their texels. In: regions. Out:
// index, cells, radiance texture, free lists.
#define CELLS_STORED
#include "lib/voxel_work.glsl"
#include "lib/voxel_texture.glsl"

layout(local_size_x = LINEAR_GROUP) in;

layout(binding = UNIT_SURFELS) uniform usamplerBuffer surfels;

void clear_texels(uint level, uint slot)
{
    ivec3 address = slot_address(level, slot);
    uint face = 0u;
    do {
        store_voxel_face(level, address, face, vec4(0.0));
    } while (++face < voxels.face_count);
}

// Clears mip voxels whose last occupied voxel was removed: filtering only visits occupied ones.
void clear_mips(uint level, ivec3 voxel)
{
    uint mip = level + 1u;
    if (mip != voxels.cell_level_count || mip >= voxels.level_count)
        return;
    do {
        clear_texels(mip, voxel_slot(mip, voxel >> int(mip - level)));
    } while (++mip < voxels.level_count);
}

void clear_voxel(uint number)
{
    uint level;
    ivec3 voxel;
    region_voxel(number, level, voxel);
    uint slot = voxel_slot(level, voxel);
    uint cell = index_word(voxels.levels[level].first_index + slot) - 1u;
    uint surfel = cell_word(cell, CELL_SURFEL);
    if (surfel != VOXEL_NONE) {
        do {
            free_words[voxels.cell_capacity + atomicAdd(counters[COUNTER_FREE_SURFELS], 1u)] =
                surfel;
            surfel = texelFetch(surfels, int(surfel * SURFEL_WORDS + SURFEL_NEXT)).x;
        } while (surfel != VOXEL_NONE);
    }
    uint left = cell_faces(cell);
    if (left != 0u) {
        do {
            uint record = cell_word(cell, CELL_FACES + uint(findLSB(left)));
            free_words[voxels.cell_capacity + 2u * voxels.surfel_capacity +
                       atomicAdd(counters[COUNTER_FREE_FACES], 1u)] = record - 1u;
        } while ((left &= left - 1u) != 0u);
    }
    cells[cell * CELL_WORDS] = VOXEL_NONE;
    free_words[atomicAdd(counters[COUNTER_FREE_CELLS], 1u)] = cell;
    voxel_index[voxels.levels[level].first_index + slot] = 0u;
    clear_texels(level, slot);
    clear_mips(level, voxel);
}

void main()
{
    uint run = region_invocation();
    FIND_OCCUPIED(run, occupied)
    if (occupied == 0u)
        return;
    do {
        clear_voxel(run * REGION_RUN + uint(findLSB(occupied)));
    } while ((occupied &= occupied - 1u) != 0u);
}
