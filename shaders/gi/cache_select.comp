// Chooses which cached irradiances to trace next. In: lists of lit cells, cells. Out: queue of cell
// faces by class of urgency.
//
// STAGE 0: faces that are not of this generation, those that pixels have asked for first, among them
// the new before those that changed much before the rest. STAGE 1: arguments of the trace.
#include "lib/voxel_cells.glsl"

layout(local_size_x = LINEAR_GROUP) in;

layout(std430, binding = BIND_VOXEL_LISTS) readonly buffer voxel_list_storage
{
    uint list_words[];
};

layout(std430, binding = BIND_VOXEL_COUNTERS) buffer voxel_counter_storage
{
    uint counters[];
};

layout(std430, binding = BIND_CACHE_QUEUE) buffer queue_storage
{
    uint queue[]; // CACHE_CLASSES runs of cell * 8 + face
};

// Requests older than this many frames are out of sight.
const uint REQUEST_FRAMES = 24u;
const uint LARGE_CHANGE = 8u; // of 255

#if STAGE == 0
void main()
{
    uint number = gl_GlobalInvocationID.x;
    if (number >= counters[COUNTER_LISTS + LIST_LIT * COUNTER_LIST_WORDS + 3u])
        return;
    uint cell = list_words[LIST_LIT * voxels.options.x + number];
    for (uint face = 0u; face < VOXEL_FACES; face++) {
        uint words = cell_face(cell, face);
        if (cells[words + CELL_FACE_NORMAL] == VOXEL_NONE)
            continue;
        uint state = cells[words + CELL_FACE_STATE];
        if ((state & 0xffffu) == voxels.cache.x)
            continue;
        uint asked = cells[words + CELL_FACE_REQUEST];
        bool seen = asked != 0u && voxels.cache.y - asked < REQUEST_FRAMES;
        if (!seen && voxels.cache.w == 0u)
            continue;
        bool traced = (state & FACE_FLAG_TRACED) != 0u;
        bool lively = ((state >> 16) & 0xffu) >= LARGE_CHANGE;
        uint urgency = (seen ? 0u : 3u) + (!traced ? 0u : lively ? 1u : 2u);
        uint at = atomicAdd(counters[COUNTER_CACHE_CLASSES + urgency], 1u);
        if (at < voxels.options.x)
            queue[urgency * voxels.options.x + at] = cell * 8u + face;
    }
}
#else
void main()
{
    if (gl_GlobalInvocationID.x != 0u)
        return;
    uint total = 0u;
    for (uint i = 0u; i < CACHE_CLASSES; i++)
        total += counters[COUNTER_CACHE_CLASSES + i];
    uint traced = min(total, voxels.cache.z);
    counters[COUNTER_CACHE_LEFT] = total - traced;
    counters[COUNTER_CACHE_TRACED] = traced;
    counters[COUNTER_CACHE_ARGUMENTS] = (traced + LINEAR_GROUP - 1u) / LINEAR_GROUP;
    counters[COUNTER_CACHE_ARGUMENTS + 1u] = 1u;
    counters[COUNTER_CACHE_ARGUMENTS + 2u] = 1u;
}
#endif
