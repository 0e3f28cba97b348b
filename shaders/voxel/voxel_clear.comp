// Empties regions: gives back their cells and surfels, and blackens their texels. In: regions. Out:
// index, cells, radiance texture, free lists.
#include "lib/voxel_work.glsl"
#include "lib/voxel_cells.glsl"
#include "lib/voxel_texture.glsl"

layout(local_size_x = LINEAR_GROUP) in;

layout(std430, binding = BIND_SURFELS) readonly buffer surfel_storage
{
    uint surfels[];
};

void main()
{
    uint level;
    ivec3 voxel;
    if (!region_voxel(region_invocation(), level, voxel))
        return;
    uint slot = voxel_slot(level, voxel);
    uint entry = voxel_index[voxels.levels[level].index.x + slot];
    if (entry == 0u)
        return;
    uint cell = entry - 1u;
    uint surfel = cells[cell * CELL_WORDS + CELL_SURFEL];
    while (surfel != VOXEL_NONE) {
        free_words[voxels.counts.z + atomicAdd(counters[COUNTER_FREE_SURFELS], 1u)] = surfel;
        surfel = surfels[surfel * SURFEL_WORDS + SURFEL_NEXT];
    }
    cells[cell * CELL_WORDS] = VOXEL_NONE;
    free_words[atomicAdd(counters[COUNTER_FREE_CELLS], 1u)] = cell;
    voxel_index[voxels.levels[level].index.x + slot] = 0u;
    ivec3 address = slot_address(level, slot);
    for (uint face = 0u; face < voxels.counts.y; face++)
        store_voxel_face(level, address, face, vec4(0.0));
}
