// Work lists of voxelization: regions to refill, and batches of triangles.
#include "lib/voxel.glsl"
#include "shared/voxel_work.h"

layout(std430, binding = BIND_VOXEL_WORK) readonly buffer voxel_work_storage
{
    voxel_region regions[VOXEL_MAX_REGIONS];
    voxel_batch batches[];
};

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
    while (i + 1u < voxels.region_count && regions[i + 1u].first_voxel <= number)
        i++;
    uvec3 size = uvec3(regions[i].size);
    uint at = number - regions[i].first_voxel;
    level = regions[i].level;
    uint row = quotient(at, size.x);
    uint layer = quotient(row, size.y);
    voxel = regions[i].low + ivec3(at - row * size.x, row - layer * size.y, layer);
    return true;
}

// Voxels per invocation, so that empty ones cost almost nothing: on CPUs a branch saves no time,
// but a loop ends when no lane has work left.
#define REGION_RUN 32u

// Occupied voxels of the run, one bit each.
#define FIND_OCCUPIED(run, out_bits)                                                               \
    uint out_bits = 0u;                                                                            \
    for (uint i_ = 0u; i_ < REGION_RUN; i_++) {                                                    \
        uint level_;                                                                               \
        ivec3 voxel_;                                                                              \
        if (region_voxel((run)*REGION_RUN + i_, level_, voxel_) &&                                 \
            voxel_index[voxels.levels[level_].first_index + voxel_slot(level_, voxel_)] != 0u)     \
            out_bits |= 1u << i_;                                                                  \
    }

// Groups of LINEAR_GROUP over x and y, since one dimension may hold only 65535 groups.
uint region_invocation()
{
    return gl_GlobalInvocationID.y * (gl_NumWorkGroups.x * uint(LINEAR_GROUP)) +
           gl_GlobalInvocationID.x;
}
