// Work lists of voxelization, in C and GLSL; std430.
#ifndef VOXCAST_SHADERS_SHARED_VOXEL_WORK_H
#define VOXCAST_SHADERS_SHARED_VOXEL_WORK_H

#include "shared/voxel_block.h"

// Voxels of a level to refill.
struct voxel_region {
    ivec3 low;
    uint level;
    ivec3 size;
    uint first_voxel; // its number over all regions
};

// Up to VOXEL_BATCH triangles of an instance, for one region.
struct voxel_batch {
    uint instance;
    uint first_triangle;
    uint triangle_count;
    uint region;
};

// VOXEL_TILE_EDGE^2 columns of a large triangle.
struct voxel_tile {
    uint instance;
    uint triangle;
    uint region;
    uint columns; // a | b << 16, in tiles
};

#ifdef __STDC__
BLOCK_SIZE(voxel_region, 2);
BLOCK_SIZE(voxel_batch, 1);
BLOCK_SIZE(voxel_tile, 1);
#endif

#endif
