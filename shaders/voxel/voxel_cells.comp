// Allocates cells for voxels that voxelization has given surfels. In: regions, index. Out: index,
// cells.
#define CELLS_STORED
#include "lib/voxel_work.glsl"

layout(local_size_x = LINEAR_GROUP) in;

uint allocate_cell()
{
    int left = int(atomicAdd(counters[COUNTER_FREE_CELLS], 0xffffffffu));
    if (left > 0)
        return free_words[left - 1];
    uint cell = atomicAdd(counters[COUNTER_CELLS], 1u);
    if (cell < voxels.cell_capacity)
        return cell;
    atomicOr(counters[COUNTER_OVERFLOW], OVERFLOW_POOLS);
    return VOXEL_NONE;
}

void make_cell(uint number)
{
    uint level;
    ivec3 voxel;
    region_voxel(number, level, voxel);
    uint slot = voxel_slot(level, voxel);
    uint at = voxels.levels[level].first_index + slot;
    uint entry = index_word(at);
    if ((entry & VOXEL_TAG_SURFEL) == 0u)
        return;
    uint cell = allocate_cell();
    voxel_index[at] = cell + 1u;
    if (cell == VOXEL_NONE)
        return;
    cells[cell * CELL_WORDS] = slot | (level << CELL_LEVEL_BIT);
    cells[cell * CELL_WORDS + CELL_SURFEL] = entry & ~VOXEL_TAG_SURFEL;
    for (uint face = 0u; face < VOXEL_FACES; face++)
        cells[cell * CELL_WORDS + CELL_FACES + face] = 0u;
}

void main()
{
    uint run = region_invocation();
    FIND_OCCUPIED(run, occupied)
    if (occupied == 0u)
        return;
    do {
        make_cell(run * REGION_RUN + uint(findLSB(occupied)));
    } while ((occupied &= occupied - 1u) != 0u);
}
