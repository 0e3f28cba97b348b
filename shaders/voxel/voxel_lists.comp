// Lists what later passes work on. LISTS_RESET: repairs the free lists' lengths and empties the
// lists. LISTS_APPEND: enters each cell into the list of those that are lit, or of those that take
// their light from the finer level; enters the occupied voxels of the mip levels below.
// LISTS_ARGUMENTS: turns the lists' lengths into arguments of indirect dispatches.
// LISTS_TILE_ARGUMENTS: likewise for the tiles of large triangles.
#include "lib/voxel_work.glsl"

layout(local_size_x = LINEAR_GROUP) in;

layout(std430, binding = BIND_VOXEL_LISTS) buffer voxel_list_storage
{
    uint list_words[]; // lists, then occupancy bits of mip voxels
};

void append(uint list, uint entry)
{
    uint at = atomicAdd(counters[COUNTER_LISTS + list * COUNTER_LIST_WORDS + 3u], 1u);
    if (at < voxels.list_capacity)
        list_words[list * voxels.list_capacity + at] = entry;
    else
        atomicOr(counters[COUNTER_OVERFLOW], OVERFLOW_POOLS);
}

// Mips and their lists derive from the coarsest level with cells.
bool mips_are_dirty()
{
    return voxels.levels[voxels.cell_level_count - 1u].dirty != 0u;
}

#if STAGE == LISTS_RESET
void main()
{
    uint list = gl_GlobalInvocationID.x;
    if (list < (mips_are_dirty() ? uint(VOXEL_MAX_LEVELS) : voxels.cell_level_count))
        counters[COUNTER_LISTS + list * COUNTER_LIST_WORDS + 3u] = 0u;
    if (list != 0u)
        return;
    uint cells_left = uint(max(int(counters[COUNTER_FREE_CELLS]), 0));
    uint left = uint(max(int(counters[COUNTER_FREE_SURFELS]), 0));
    counters[COUNTER_FREE_CELLS] = cells_left;
    counters[COUNTER_FREE_FACES] = uint(max(int(counters[COUNTER_FREE_FACES]), 0));
    counters[COUNTER_FACES] = min(counters[COUNTER_FACES], voxels.face_capacity);
    for (uint i = 0u; i < counters[COUNTER_RETURNED_SURFELS]; i++)
        free_words[voxels.cell_capacity + left++] =
            free_words[voxels.cell_capacity + voxels.surfel_capacity + i];
    counters[COUNTER_FREE_SURFELS] = left;
    counters[COUNTER_RETURNED_SURFELS] = 0u;
    counters[COUNTER_CELLS] = min(counters[COUNTER_CELLS], voxels.cell_capacity);
    counters[COUNTER_SURFELS] = min(counters[COUNTER_SURFELS], voxels.surfel_capacity);
}
#elif STAGE == LISTS_APPEND
// An invocation takes so many cells and makes room for those that are lit at once: the counter is
// what all would wait for otherwise.
const uint CELL_RUN = 16u;

// List of a cell; VOXEL_NONE for a free cell.
uint list_of(uint word)
{
    if (word == VOXEL_NONE)
        return VOXEL_NONE;
    uint level = word >> CELL_LEVEL_BIT;
    ivec3 inside = slot_voxel(level, word & CELL_SLOT_MASK) - voxels.levels[level].inner_origin;
    bool filtered = all(greaterThanEqual(inside, ivec3(0))) &&
                    all(lessThan(inside, ivec3(voxels.levels[level].inner_edge)));
    return filtered ? level : LIST_LIT;
}

void append_mips(uint slot)
{
    uint base = voxels.cell_level_count - 1u;
    ivec3 voxel = slot_voxel(base, slot);
    uint bits = voxels.level_count * voxels.list_capacity;
    uint first_bit = 0u;
    uint mip = base + 1u;
    if (mip >= voxels.level_count)
        return;
    do {
        uint coarse = voxel_slot(mip, voxel >> int(mip - base));
        uint number = first_bit + coarse;
        uint bit = 1u << (number & 31u);
        if ((atomicOr(list_words[bits + (number >> 5)], bit) & bit) == 0u)
            append(mip, coarse);
        first_bit += 1u << (3u * voxels.levels[mip].edge_log2);
    } while (++mip < voxels.level_count);
}

void main()
{
    uint first = region_invocation() * CELL_RUN;
    uint end = min(first + CELL_RUN, counters[COUNTER_CELLS]);
    bool mips = mips_are_dirty();
    uint lit = 0u, filtered = 0u, of_base = 0u; // a bit per cell
    uint cell = first;
    if (cell >= end)
        return;
    do {
        uint bit = 1u << (cell - first);
        uint word = cell_word(cell, 0u);
        uint list = list_of(word);
        lit |= list == LIST_LIT ? bit : 0u;
        filtered |= list != LIST_LIT && list != VOXEL_NONE ? bit : 0u;
        bool base = word != VOXEL_NONE && (word >> CELL_LEVEL_BIT) == voxels.cell_level_count - 1u;
        of_base |= mips && base ? bit : 0u;
    } while (++cell < end);
    uint count = uint(bitCount(lit));
    uint at = atomicAdd(counters[COUNTER_LISTS + LIST_LIT * COUNTER_LIST_WORDS + 3u], count);
    if (at + count > voxels.list_capacity) {
        atomicOr(counters[COUNTER_OVERFLOW], OVERFLOW_POOLS);
        lit = 0u;
    }
    if (lit != 0u) {
        do {
            list_words[LIST_LIT * voxels.list_capacity + at++] = first + uint(findLSB(lit));
        } while ((lit &= lit - 1u) != 0u);
    }
    if (filtered != 0u) {
        do {
            uint word = cell_word(first + uint(findLSB(filtered)), 0u);
            append(word >> CELL_LEVEL_BIT, word & CELL_SLOT_MASK);
        } while ((filtered &= filtered - 1u) != 0u);
    }
    if (of_base != 0u) {
        do {
            append_mips(cell_word(first + uint(findLSB(of_base)), 0u) & CELL_SLOT_MASK);
        } while ((of_base &= of_base - 1u) != 0u);
    }
}
#elif STAGE == LISTS_TILE_ARGUMENTS
void main()
{
    if (gl_GlobalInvocationID.x != 0u)
        return;
    counters[COUNTER_TILES] = min(counters[COUNTER_TILES], voxels.tile_capacity);
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
    uint count = min(counters[at + 3u], voxels.list_capacity);
    counters[at] = (count + LINEAR_GROUP - 1u) / LINEAR_GROUP;
    counters[at + 1u] = 1u;
    counters[at + 2u] = 1u;
    counters[at + 3u] = count;
}
#endif
