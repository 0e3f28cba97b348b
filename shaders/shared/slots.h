// Binding points of buffers, images and textures, in C and GLSL.
#ifndef VOXCAST_SHADERS_SHARED_SLOTS_H
#define VOXCAST_SHADERS_SHARED_SLOTS_H

// Uniform blocks
#define BIND_FRAME  0
#define BIND_VOXELS 1

// Shader storage blocks: what shaders write. What they only read has a texture unit, below.
#define BIND_GBUFFER        0
#define BIND_RADIANCE       1
#define BIND_LIGHT_MASKS    2
#define BIND_OUTPUT         3
#define BIND_EXPOSURE       4
#define BIND_FRAGMENTS      5
#define BIND_TILES          6
#define BIND_INDIRECT       7
#define BIND_VOXEL_INDEX    8
#define BIND_CELLS          9
#define BIND_FACES          10
#define BIND_SURFELS        11
#define BIND_VOXEL_COUNTERS 12
#define BIND_VOXEL_FREE     13
#define BIND_VOXEL_TILES    14
#define BIND_VOXEL_LISTS    15
#define BIND_CACHE_QUEUE    16
#define BIND_CHECK          17 // this and the next: shaders/debug/finite_check.comp only
#define BIND_CHECKED        18
#define STORAGE_BINDINGS    19

// Image units
#define IMAGE_VOXEL_RADIANCE 0

// Texture units. A stage has 32 at most (llvmpipe, NVIDIA), whatever their numbers.
#define UNIT_IDS              0
#define UNIT_DEPTH            1
#define UNIT_SHADOW_MAP       2
#define UNIT_VOXEL_RADIANCE   3
#define UNIT_ENVIRONMENT      4
#define UNIT_COLOR_CLASSES    5
#define UNIT_DATA_CLASSES     10
#define MAX_CLASSES_PER_SPACE 5
#define UNIT_BACKGROUND       15
#define UNIT_CHECKED          16

// Of buffers as texels
#define UNIT_SCENE_TABLES   17
#define UNIT_VERTICES       18
#define UNIT_TRIANGLES      19
#define UNIT_BVH_NODES      20
#define UNIT_BVH_TRIANGLES  21
#define UNIT_SHADOW_VIEWS   22
#define UNIT_GBUFFER        23
#define UNIT_RADIANCE       24
#define UNIT_LIGHT_MASKS    25
#define UNIT_EXPOSURE       26
#define UNIT_FRAGMENTS      27
#define UNIT_ACCUMULATION   28
#define UNIT_VOXEL_INDEX    29
#define UNIT_CELLS          30
#define UNIT_FACES          31
#define UNIT_SURFELS        32
#define UNIT_VOXEL_WORK     33
#define UNIT_VOXEL_LISTS    34
#define UNIT_VOXEL_SURFACES 35
#define UNIT_CACHE_QUEUE    36

#endif
