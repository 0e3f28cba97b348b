// Selects which face records to trace next. In: list of lit cells, cells. Out: queue of face
// records by class of urgency.
//
// STAGE 0: queues faces to march (cones not traced through the present geometry) and faces to look
// up (light of an older generation). Requested faces come first; among those to march new ones
// lead, among those to look up ones that changed much. STAGE 1: dispatch arguments.
#include "lib/voxel_cells.glsl"

layout(local_size_x = LINEAR_GROUP) in;

layout(binding = UNIT_VOXEL_LISTS) uniform usamplerBuffer list_texels;

layout(std430, binding = BIND_VOXEL_COUNTERS) buffer voxel_counter_storage
{
    uint counters[];
};

layout(std430, binding = BIND_CACHE_QUEUE) buffer queue_storage
{
    uint queue[]; // CACHE_CLASSES runs of first words of face records
};

// Requests older than this many frames are out of view.
const uint REQUEST_FRAMES = 24u;
const uint LARGE_CHANGE = 2u; // of 63

void enqueue(uint urgency, uint entry)
{
    uint at = atomicAdd(counters[COUNTER_CACHE_CLASSES + urgency], 1u);
    if (at < voxels.list_capacity)
        queue[urgency * voxels.list_capacity + at] = entry;
}

#if STAGE == SELECT_FACES
void main()
{
    uint number = gl_GlobalInvocationID.x;
    if (number >= counters[COUNTER_LISTS + LIST_LIT * COUNTER_LIST_WORDS + 3u])
        return;
    uint cell = texelFetch(list_texels, int(LIST_LIT * voxels.list_capacity + number)).x;
    uint left = cell_faces(cell);
    if (left == 0u)
        return;
    do {
        uint words = cell_face(cell, uint(findLSB(left)));
        if (face_word(words, FACE_NORMAL) == VOXEL_NONE)
            continue;
        uint state = face_word(words, FACE_STATE);
        bool marched = (state & FACE_MARCHED) != 0u;
        bool fresh = marched && (state >> FACE_EPOCH_BIT) == voxels.geometry_epoch;
        bool lit = (state & 0xffffu) == voxels.cache_generation;
        if (lit && fresh)
            continue;
        uint asked = face_word(words, FACE_REQUEST);
        bool seen = asked != 0u && voxels.frame_number - asked < REQUEST_FRAMES;
        if (!seen && voxels.all_faces == 0u)
            continue;
        if (!fresh)
            enqueue(!seen ? 2u : marched ? 1u : 0u, words);
        if (!lit && marched) {
            bool lively = ((state >> FACE_CHANGE_BIT) & 63u) >= LARGE_CHANGE;
            enqueue(CACHE_MARCH_CLASSES + (!seen ? 2u : lively ? 0u : 1u), words);
        }
    } while ((left &= left - 1u) != 0u);
}
#else
uint count_classes(uint first, uint end, uint maximum)
{
    uint total = 0u;
    for (uint i = first; i < end; i++)
        total += min(counters[COUNTER_CACHE_CLASSES + i], maximum);
    return total;
}

void set_arguments(uint at, uint count)
{
    counters[at] = (count + LINEAR_GROUP - 1u) / LINEAR_GROUP;
    counters[at + 1u] = 1u;
    counters[at + 2u] = 1u;
    counters[at + 3u] = count;
}

void main()
{
    if (gl_GlobalInvocationID.x != 0u)
        return;
    // The budget counts marches. Look-ups are cheap and show an edit everywhere, so they go first,
    // but leave a quarter of the budget.
    uint to_march = count_classes(0u, CACHE_MARCH_CLASSES, voxels.list_capacity);
    uint to_look_up = count_classes(CACHE_MARCH_CLASSES, CACHE_CLASSES, voxels.list_capacity);
    uint budget = voxels.trace_budget;
    uint looked_up = min(to_look_up, (budget - min(to_march, budget / 4u)) * CACHE_MARCH_COST);
    uint marched = min(to_march, budget - looked_up / CACHE_MARCH_COST);
    set_arguments(COUNTER_MARCH, marched);
    set_arguments(COUNTER_LOOKUP, looked_up);
    // Faces that did not fit into the queue are left, too.
    counters[COUNTER_CACHE_LEFT] =
        count_classes(0u, CACHE_CLASSES, 0xffffffffu) - marched - looked_up;
    counters[COUNTER_CACHE_TRACED] = marched * CACHE_MARCH_COST + looked_up;
}
#endif
