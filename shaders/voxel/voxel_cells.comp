// Makes cells of the voxels that voxelization has given surfels, inheriting irradiance from the next
// coarser level, so that a voxel that comes into reach is not black until its cones are traced. In:
// regions, index. Out: index, cells.
#include "lib/voxel_work.glsl"
#include "lib/voxel_cells.glsl"

layout(local_size_x = LINEAR_GROUP) in;

uint allocate_cell()
{
    int left = int(atomicAdd(counters[COUNTER_FREE_CELLS], 0xffffffffu));
    if (left > 0)
        return free_words[left - 1];
    uint cell = atomicAdd(counters[COUNTER_CELLS], 1u);
    if (cell < voxels.counts.z)
        return cell;
    atomicOr(counters[COUNTER_OVERFLOW], 1u);
    return VOXEL_NONE;
}

void main()
{
    uint level;
    ivec3 voxel;
    if (!region_voxel(region_invocation(), level, voxel))
        return;
    uint slot = voxel_slot(level, voxel);
    uint at = voxels.levels[level].index.x + slot;
    uint entry = voxel_index[at];
    if ((entry & VOXEL_TAG_SURFEL) == 0u)
        return;
    uint cell = allocate_cell();
    voxel_index[at] = cell + 1u;
    if (cell == VOXEL_NONE)
        return;
    uint parent = VOXEL_NONE;
    if (level + 1u < voxels.counts.x && voxels.levels[level + 1u].index.z != 0u &&
        voxel_in_level(level + 1u, voxel >> 1)) {
        uint word = voxel_index[voxels.levels[level + 1u].index.x + voxel_slot(level + 1u, voxel >> 1)];
        if ((word & VOXEL_TAG_SURFEL) == 0u)
            parent = word - 1u;
    }
    cells[cell * CELL_WORDS] = slot | (level << CELL_LEVEL_BIT);
    cells[cell * CELL_WORDS + CELL_SURFEL] = entry & ~VOXEL_TAG_SURFEL;
    for (uint face = 0u; face < VOXEL_FACES; face++) {
        uint to = cell_face(cell, face);
        cells[to + CELL_FACE_NORMAL] = VOXEL_NONE;
        cells[to + CELL_FACE_PLACE] = 0u;
        cells[to + CELL_FACE_REQUEST] = 0u;
        cells[to + CELL_FACE_LIGHT] = 0u;
        cells[to + CELL_FACE_LIGHT + 1u] = 0u;
        cells[to + CELL_FACE_STATE] = 0u;
        if (parent == VOXEL_NONE)
            continue;
        uint from = cell_face(parent, face);
        cells[to + CELL_FACE_LIGHT] = cells[from + CELL_FACE_LIGHT];
        cells[to + CELL_FACE_LIGHT + 1u] = cells[from + CELL_FACE_LIGHT + 1u];
        cells[to + CELL_FACE_STATE] = cells[from + CELL_FACE_STATE] & FACE_FLAG_VALID;
    }
}
