// Lists what later passes work on. STAGE 0: mends the free lists' lengths and empties the lists.
// STAGE 1: enters each cell into the list of those that are lit, or of those that take their light
// from the finer level; without clip levels, enters the occupied voxels of the mip levels. STAGE 2:
// turns the lists' lengths into arguments of indirect dispatches. STAGE 3: likewise for the tiles of
// large triangles.
#include "lib/voxel_work.glsl"
#include "lib/voxel_cells.glsl"

layout(local_size_x = LINEAR_GROUP) in;

layout(std430, binding = BIND_VOXEL_LISTS) buffer voxel_list_storage
{
    uint list_words[]; // the lists; then bits of occupied mip voxels
};

void append(uint list, uint entry)
{
    uint at = atomicAdd(counters[COUNTER_LISTS + list * COUNTER_LIST_WORDS + 3u], 1u);
    if (at < voxels.options.x)
        list_words[list * voxels.options.x + at] = entry;
    else
        atomicOr(counters[COUNTER_OVERFLOW], 1u);
}

#if STAGE == 0
void main()
{
    uint list = gl_GlobalInvocationID.x;
    if (list < uint(VOXEL_MAX_LEVELS))
        counters[COUNTER_LISTS + list * COUNTER_LIST_WORDS + 3u] = 0u;
    if (list != 0u)
        return;
    uint cells_left = uint(max(int(counters[COUNTER_FREE_CELLS]), 0));
    uint left = uint(max(int(counters[COUNTER_FREE_SURFELS]), 0));
    counters[COUNTER_FREE_CELLS] = cells_left;
    for (uint i = 0u; i < counters[COUNTER_RETURNED_SURFELS]; i++)
        free_words[voxels.counts.z + left++] =
            free_words[voxels.counts.z + voxels.counts.w + i];
    counters[COUNTER_FREE_SURFELS] = left;
    counters[COUNTER_RETURNED_SURFELS] = 0u;
    counters[COUNTER_CELLS] = min(counters[COUNTER_CELLS], voxels.counts.z);
    counters[COUNTER_SURFELS] = min(counters[COUNTER_SURFELS], voxels.counts.w);
}
#elif STAGE == 1
void main()
{
    uint cell = region_invocation();
    if (cell >= counters[COUNTER_CELLS])
        return;
    uint word = cells[cell * CELL_WORDS];
    if (word == VOXEL_NONE)
        return;
    uint level = word >> CELL_LEVEL_BIT;
    uint slot = word & CELL_SLOT_MASK;
    ivec3 voxel = slot_voxel(level, slot);
    ivec3 inside = voxel - voxels.levels[level].inner.xyz;
    bool filtered = all(greaterThanEqual(inside, ivec3(0))) &&
                    all(lessThan(inside, ivec3(voxels.levels[level].inner.w)));
    append(filtered ? level : LIST_LIT, filtered ? slot : cell);
#if MIPS
    uint bits = uint(VOXEL_MAX_LEVELS) * voxels.options.x;
    uint first_bit = 0u;
    for (uint mip = 1u; mip < voxels.counts.x; mip++) {
        uint coarse = voxel_slot(mip, voxel >> int(mip));
        uint number = first_bit + coarse;
        uint bit = 1u << (number & 31u);
        if ((atomicOr(list_words[bits + (number >> 5)], bit) & bit) == 0u)
            append(mip, coarse);
        first_bit += 1u << (3u * voxels.levels[mip].index.y);
    }
#endif
}
#elif STAGE == 3
void main()
{
    if (gl_GlobalInvocationID.x != 0u)
        return;
    counters[COUNTER_TILES] = min(counters[COUNTER_TILES], voxels.work.w);
    counters[COUNTER_TILES + 1] = 1u;
    counters[COUNTER_TILES + 2] = 1u;
}
#else
void main()
{
    uint list = gl_GlobalInvocationID.x;
    if (list == 0u)
        counters[COUNTER_CACHE_LEFT] = 0u;
    if (list >= uint(VOXEL_MAX_LEVELS))
        return;
    uint at = COUNTER_LISTS + list * COUNTER_LIST_WORDS;
    uint count = min(counters[at + 3u], voxels.options.x);
    counters[at] = (count + LINEAR_GROUP - 1u) / LINEAR_GROUP;
    counters[at + 1u] = 1u;
    counters[at + 2u] = 1u;
    counters[at + 3u] = count;
}
#endif
