// Work lists of voxelization: regions to refill, and batches of triangles.
#include "lib/voxel_cells.glsl"
#include "shared/voxel_work.h"

// VOXEL_MAX_REGIONS of voxel_region, and then voxel_batch.
layout(binding = UNIT_VOXEL_WORK) uniform usamplerBuffer work_texels;

voxel_region load_region(uint number)
{
    uvec4 low = texelFetch(work_texels, int(2u * number));
    uvec4 size = texelFetch(work_texels, int(2u * number + 1u));
    return voxel_region(ivec3(low.xyz), low.w, ivec3(size.xyz), size.w);
}

voxel_batch load_batch(uint number)
{
    uvec4 words = texelFetch(work_texels, int(2u * uint(VOXEL_MAX_REGIONS) + number));
    return voxel_batch(words.x, words.y, words.z, words.w);
}

layout(std430, binding = BIND_VOXEL_COUNTERS) coherent buffer voxel_counter_storage
{
    uint counters[];
};

layout(std430, binding = BIND_VOXEL_FREE) coherent buffer voxel_free_storage
{
    uint free_words[]; // free cells, free surfels, returned surfels
};

// a / b for a < 2^24: CPUs divide integers lane by lane.
uint quotient(uint a, uint b)
{
    uint q = uint(float(a) / float(b));
    return q * b > a ? q - 1u : (q + 1u) * b <= a ? q + 1u : q;
}

// The voxel of an invocation; false past the last one.
bool region_voxel(uint number, out uint level, out ivec3 voxel)
{
    if (number >= voxels.region_voxel_count)
        return false;
    uint i = 0u;
    bool later;
    do {
        later = i + 1u < voxels.region_count &&
                texelFetch(work_texels, int(2u * i + 3u)).w <= number; // its first voxel
        i += later ? 1u : 0u;
    } while (later);
    voxel_region region = load_region(i);
    uvec3 size = uvec3(region.size);
    uint at = number - region.first_voxel;
    level = region.level;
    uint row = quotient(at, size.x);
    uint layer = quotient(row, size.y);
    voxel = region.low + ivec3(at - row * size.x, row - layer * size.y, layer);
    return true;
}

// Voxels per invocation, so that empty ones cost almost nothing: on CPUs a branch saves no time,
// but a loop ends when no lane has work left.
#define REGION_RUN 32u

// Occupied voxels of the run, one bit each.
#define FIND_OCCUPIED(run, out_bits)                                                               \
    uint out_bits = 0u;                                                                            \
    uint i_ = 0u;                                                                                  \
    do {                                                                                           \
        uint level_;                                                                               \
        ivec3 voxel_;                                                                              \
        if (region_voxel((run)*REGION_RUN + i_, level_, voxel_) &&                                 \
            index_word(voxels.levels[level_].first_index + voxel_slot(level_, voxel_)) != 0u)      \
            out_bits |= 1u << i_;                                                                  \
    } while (++i_ < REGION_RUN);

// Groups of LINEAR_GROUP over x and y, since one dimension may hold only 65535 groups.
uint region_invocation()
{
    return gl_GlobalInvocationID.y * (gl_NumWorkGroups.x * uint(LINEAR_GROUP)) +
           gl_GlobalInvocationID.x;
}
