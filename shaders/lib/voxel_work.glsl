// What voxelization works through: regions of voxels to fill anew, and batches of triangles.
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
    uint free_words[]; // free cells, free surfels, surfels that were taken but not needed
};

// a / b for a < 2^24: integers are divided lane by lane on CPUs.
uint quotient(uint a, uint b)
{
    uint q = uint(float(a) / float(b));
    return q * b > a ? q - 1u : (q + 1u) * b <= a ? q + 1u : q;
}

// Finds the voxel that an invocation is for; false beyond the last one.
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

// One invocation goes through so many voxels, so that those of no interest cost next to nothing: on
// CPUs a branch saves no time, but a loop ends when no lane has anything left.
#define REGION_RUN 32u

// Which of the run's voxels are occupied, one bit each.
#define FIND_OCCUPIED(run, out_bits)                                                               \
    uint out_bits = 0u;                                                                            \
    for (uint i_ = 0u; i_ < REGION_RUN; i_++) {                                                    \
        uint level_;                                                                               \
        ivec3 voxel_;                                                                              \
        if (region_voxel((run)*REGION_RUN + i_, level_, voxel_) &&                                 \
            voxel_index[voxels.levels[level_].first_index + voxel_slot(level_, voxel_)] != 0u)     \
            out_bits |= 1u << i_;                                                                  \
    }

// Groups of LINEAR_GROUP over x and y, since one dimension may hold 65535 groups only.
uint region_invocation()
{
    return gl_GlobalInvocationID.y * (gl_NumWorkGroups.x * uint(LINEAR_GROUP)) +
           gl_GlobalInvocationID.x;
}
