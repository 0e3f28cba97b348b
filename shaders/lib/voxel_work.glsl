// What voxelization works through: regions of voxels to fill anew, and chunks of triangles.
#include "lib/voxel.glsl"

struct voxel_region {
    ivec4 low;  // w: level
    ivec4 size; // w: number of its first voxel among those of all regions
};

layout(std430, binding = BIND_VOXEL_WORK) readonly buffer voxel_work_storage
{
    voxel_region regions[VOXEL_MAX_REGIONS];
    uvec4 chunks[]; // instance, first triangle, triangles, region
};

layout(std430, binding = BIND_VOXEL_COUNTERS) coherent buffer voxel_counter_storage
{
    uint counters[];
};

layout(std430, binding = BIND_VOXEL_FREE) coherent buffer voxel_free_storage
{
    uint free_words[]; // free cells, free surfels, surfels that were taken but not needed
};

// Finds the voxel that an invocation is for; false beyond the last one.
bool region_voxel(uint number, out uint level, out ivec3 voxel)
{
    if (number >= voxels.work.y)
        return false;
    uint i = 0u;
    while (i + 1u < voxels.work.x && uint(regions[i + 1u].size.w) <= number)
        i++;
    uvec3 size = uvec3(regions[i].size.xyz);
    uint at = number - uint(regions[i].size.w);
    level = uint(regions[i].low.w);
    voxel = regions[i].low.xyz + ivec3(at % size.x, (at / size.x) % size.y, at / (size.x * size.y));
    return true;
}

// Over x and y, since one dimension may hold 65535 groups only.
uint region_invocation()
{
    return gl_GlobalInvocationID.y * (gl_NumWorkGroups.x * gl_WorkGroupSize.x) +
           gl_GlobalInvocationID.x;
}
