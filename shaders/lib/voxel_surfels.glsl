// Adds a triangle's part of a voxel to the voxel's surfels.
#include "lib/voxel_work.glsl"

layout(std430, binding = BIND_VOXEL_INDEX) coherent buffer voxel_index_storage
{
    uint voxel_index[];
};

layout(std430, binding = BIND_SURFELS) coherent buffer surfel_storage
{
    uint surfels[]; // SURFEL_WORDS each
};

struct voxel_fragment {
    uint mask;
    uint weight;
    vec3 normal;             // unit
    vec3 sub_voxel_position; // in the voxel, 0 to 1
    float opacity;
    vec3 color;
    vec3 emission;
};

uint allocate_surfel(uint key)
{
    uint surfel;
    int left = int(atomicAdd(counters[COUNTER_FREE_SURFELS], 0xffffffffu));
    if (left > 0) {
        surfel = free_words[voxels.cell_capacity + uint(left) - 1u];
    } else {
        surfel = atomicAdd(counters[COUNTER_SURFELS], 1u);
        if (surfel >= voxels.surfel_capacity) {
            atomicOr(counters[COUNTER_OVERFLOW], OVERFLOW_POOLS);
            return VOXEL_NONE;
        }
    }
    for (uint i = 0u; i < SURFEL_WORDS; i++)
        surfels[surfel * SURFEL_WORDS + i] = 0u;
    surfels[surfel * SURFEL_WORDS + SURFEL_KEY] = key;
    return surfel;
}

// The surfel of a key in a voxel's list; `spare` is one that was allocated but not needed, or NONE.
uint find_surfel(uint index_word, uint key, inout uint spare)
{
    uint seen = VOXEL_NONE; // head of the part already searched
    for (;;) {
        uint entry = atomicOr(voxel_index[index_word], 0u);
        uint head = entry == 0u ? VOXEL_NONE : entry & ~VOXEL_TAG_SURFEL;
        uint at = head;
        if (at != VOXEL_NONE && at != seen) {
            do {
                if (surfels[at * SURFEL_WORDS + SURFEL_KEY] == key)
                    return at;
                at = surfels[at * SURFEL_WORDS + SURFEL_NEXT];
            } while (at != VOXEL_NONE && at != seen);
        }
        seen = head;
        if (spare == VOXEL_NONE)
            spare = allocate_surfel(key);
        if (spare == VOXEL_NONE)
            return VOXEL_NONE;
        surfels[spare * SURFEL_WORDS + SURFEL_KEY] = key;
        surfels[spare * SURFEL_WORDS + SURFEL_NEXT] = head;
        memoryBarrierBuffer();
        if (atomicCompSwap(voxel_index[index_word], entry, spare | VOXEL_TAG_SURFEL) == entry) {
            uint taken = spare;
            spare = VOXEL_NONE;
            return taken;
        }
    }
}

void give_back_surfel(uint spare)
{
    if (spare != VOXEL_NONE)
        free_words[voxels.cell_capacity + voxels.surfel_capacity +
                   atomicAdd(counters[COUNTER_RETURNED_SURFELS], 1u)] = spare;
}

void add3(uint word, vec3 value, float scale, uint weight)
{
    ivec3 whole = ivec3(round(value * scale)) * int(weight);
    atomicAdd(surfels[word], uint(whole.x));
    atomicAdd(surfels[word + 1u], uint(whole.y));
    atomicAdd(surfels[word + 2u], uint(whole.z));
}

void add_fragment(uint surfel, voxel_fragment f)
{
    uint word = surfel * SURFEL_WORDS;
    atomicOr(surfels[word + SURFEL_MASK], f.mask);
    if (atomicAdd(surfels[word + SURFEL_WEIGHT], f.weight) >= SURFEL_WEIGHT_MAX) {
        atomicAdd(surfels[word + SURFEL_WEIGHT], uint(-int(f.weight)));
        return;
    }
    add3(word + SURFEL_NORMAL, f.normal, 127.0, f.weight);
    add3(word + SURFEL_SUB_VOXEL_POSITION, f.sub_voxel_position, 255.0, f.weight);
    atomicAdd(surfels[word + SURFEL_OPACITY], uint(round(f.opacity * 255.0)) * f.weight);
#if VOXEL_COLORS
    add3(word + SURFEL_COLOR, f.color, 255.0, f.weight);
    add3(word + SURFEL_EMISSION, f.emission, 255.0, f.weight);
#endif
}
