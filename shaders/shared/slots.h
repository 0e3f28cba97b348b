// Binding points of buffers, images and textures, in C and GLSL.
#ifndef VOXCAST_SHADERS_SHARED_SLOTS_H
#define VOXCAST_SHADERS_SHARED_SLOTS_H

// Uniform blocks
#define BIND_FRAME    0
#define BIND_VOXELS   1
#define BIND_SETTINGS 2

// Shader storage blocks: what shaders write. What they only read has a texture unit, below. The
// buffers of a view come behind: the rows of renderer/frame/frame.def give BIND_ and UNIT_ for
// each, such as BIND_GBUFFER, which stand before all shaders.
#define BIND_VOXEL_INDEX    0
#define BIND_CELLS          1
#define BIND_FACES          2
#define BIND_SURFELS        3
#define BIND_VOXEL_COUNTERS 4
#define BIND_VOXEL_FREE     5
#define BIND_VOXEL_TILES    6
#define BIND_VOXEL_LISTS    7
#define BIND_CACHE_QUEUE    8
#define BIND_CHECK          9 // this and the next: shaders/debug/finite_check.comp only
#define BIND_CHECKED        10
#define BIND_VIEW_BUFFERS   11
#define STORAGE_BINDINGS    32

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
#define UNIT_VOXEL_INDEX    23
#define UNIT_CELLS          24
#define UNIT_FACES          25
#define UNIT_SURFELS        26
#define UNIT_VOXEL_WORK     27
#define UNIT_VOXEL_LISTS    28
#define UNIT_VOXEL_SURFACES 29
#define UNIT_CACHE_QUEUE    30
#define UNIT_VIEW_BUFFERS   31
#define TEXTURE_UNITS       64

#endif
