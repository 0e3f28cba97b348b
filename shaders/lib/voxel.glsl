// Addresses of voxels and cells. Voxel coordinates count from the volume's anchor. Those of a
// toroidal level wrap in memory, so that a moved level keeps what it still covers.
#include "lib/frame.glsl"
#include "shared/voxel_records.h"

layout(std140, binding = BIND_VOXELS) uniform voxel_uniforms
{
    voxel_block voxels;
};

uint voxel_slot(uint level, ivec3 voxel)
{
    ivec3 origin = voxels.levels[level].origin;
    ivec3 start = voxels.levels[level].wraps != 0u ? ivec3(0) : origin;
    ivec3 at = (voxel - start) & (voxels.levels[level].edge - 1);
    uint shift = voxels.levels[level].edge_log2;
    return uint(at.x) | (uint(at.y) << shift) | (uint(at.z) << (2u * shift));
}

ivec3 slot_address(uint level, uint slot)
{
    uint shift = voxels.levels[level].edge_log2;
    uint mask = (1u << shift) - 1u;
    return ivec3(slot & mask, (slot >> shift) & mask, slot >> (2u * shift));
}

// The voxel that a slot holds now.
ivec3 slot_voxel(uint level, uint slot)
{
    ivec3 origin = voxels.levels[level].origin;
    ivec3 at = slot_address(level, slot);
    if (voxels.levels[level].wraps == 0u)
        return origin + at;
    return origin + ((at - origin) & (voxels.levels[level].edge - 1));
}

bool voxel_in_level(uint level, ivec3 voxel)
{
    ivec3 origin = voxels.levels[level].origin;
    ivec3 at = voxel - origin;
    return all(greaterThanEqual(at, ivec3(0))) &&
           all(lessThan(at, ivec3(voxels.levels[level].edge)));
}

vec3 face_direction(uint face)
{
    float turn = (face & 1u) == 0u ? 1.0 : -1.0;
    uint axis = face >> 1u;
    return vec3(axis == 0u ? turn : 0.0, axis == 1u ? turn : 0.0, axis == 2u ? turn : 0.0);
}

// The face nearest to a direction: dominant axis and side.
uint dominant_face(vec3 n)
{
    vec3 size = abs(n);
    uint axis = size.x >= size.y && size.x >= size.z ? 0u : size.y >= size.z ? 1u : 2u;
    float along = axis == 0u ? n.x : axis == 1u ? n.y : n.z;
    return 2u * axis + (along < 0.0 ? 1u : 0u);
}
