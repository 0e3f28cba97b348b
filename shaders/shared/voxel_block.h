// A voxel volume, in C and GLSL; std140.
#ifndef VOXCAST_SHADERS_SHARED_VOXEL_BLOCK_H
#define VOXCAST_SHADERS_SHARED_VOXEL_BLOCK_H

#include "shared/types.h"

#define VOXEL_MAX_LEVELS 12
#define VOXEL_MAX_CONES  32
#define VOXEL_FACES      6

// Optical depth of a fully covered voxel: transmits e^-8, 0.03 %.
#define VOXEL_MAX_DEPTH 8.0

// Triangles that span more voxel columns are split into tiles of so many columns.
#define VOXEL_SMALL_COLUMNS 12
#define VOXEL_TILE_EDGE     8
#define VOXEL_MAX_REGIONS   96
#define VOXEL_BATCH         64 // triangles per batch

struct voxel_level_block {
    ivec3 origin;       // lowest voxel, in voxels of this level from the anchor
    int edge;           // voxels along an edge
    ivec3 inner_origin; // lowest voxel filled from the finer level
    int inner_edge;     // voxels along an edge; 0: none
    ivec3 texel_origin; // first texel of face 0 inside the border
    int face_stride;    // texels between faces
    uint first_index;   // first word in the index
    uint edge_log2;
    uint wraps; // 1: toroidal addresses
    uint dirty; // 1: some region must be voxelized
    float voxel_edge_m;
    float inverse_voxel_edge; // 1/m
    float unused_0;
    float unused_1;
};

// How to march a cone set.
struct cone_march {
    float step_diameters;
    float start_voxels;
    float cone_count;
    float tan_half_angle;
};

struct voxel_cone {
    vec3 direction; // about +Z
    float weight;   // cosine over the sum of cosines
};

struct voxel_block {
    vec3 anchor;          // world
    float radiance_scale; // stored radiance is divided by it
    uint level_count;
    uint face_count; // faces per voxel in the texture
    uint cell_capacity;
    uint surfel_capacity;
    uint region_count; // regions to voxelize
    uint region_voxel_count;
    uint batch_count; // batches of triangles
    uint tile_capacity;
    uint cache_generation;
    uint frame_number;
    uint trace_budget; // cache entries per frame
    uint all_faces;    // 1: trace faces that no pixel has requested, too
    float ao_radius_m; // reach of ambient occlusion
    float unused_0;
    float specular_max_roughness; // rougher surfaces use the cache
    float cone_max_diameter_m;
    float peak_radiance;            // of the last generation's brightest face / scale
    float sample_count;             // samples in the accumulation
    float specular_min_reflectance; // surfaces of lower reflectance use the cache
    float unused_1;
    BLOCK_STRUCT(cone_march) cache_march;
    BLOCK_STRUCT(cone_march) pixel_march;
    uint cell_level_count; // levels with cells of their own; the rest are mips of the last
    uint face_record_words;
    uint face_capacity; // in face records
    uint geometry_epoch;
    uint list_capacity;
    uint first_level; // first level to inject into, or the level to filter
    uint end_level;
    uint instance_count;
    BLOCK_STRUCT(voxel_cone) cache_cones[VOXEL_MAX_CONES];
    BLOCK_STRUCT(voxel_cone) pixel_cones[VOXEL_MAX_CONES];
    BLOCK_STRUCT(voxel_level_block) levels[VOXEL_MAX_LEVELS];
};

#ifdef __STDC__
BLOCK_SIZE(voxel_level_block, 5);
BLOCK_SIZE(voxel_block, 10 + 2 * VOXEL_MAX_CONES + 5 * VOXEL_MAX_LEVELS);
#endif

#endif
