// Binding points of buffers, images and textures, in C and GLSL.
#ifndef VOXCAST_SHADERS_SHARED_SLOTS_H
#define VOXCAST_SHADERS_SHARED_SLOTS_H

// Uniform blocks
#define BIND_FRAME  0
#define BIND_VOXELS 1

// Shader storage blocks
#define BIND_INSTANCES      0
#define BIND_ID_BLOCKS      1
#define BIND_VERTICES       2
#define BIND_INDICES        3
#define BIND_MATERIALS      4
#define BIND_TEXTURES       5
#define BIND_LIGHTS         6
#define BIND_AREA_LIGHTS    7
#define BIND_SHADOW_VIEWS   8
#define BIND_GBUFFER        9
#define BIND_RADIANCE       10
#define BIND_LIGHT_MASKS    11
#define BIND_OUTPUT         12
#define BIND_EXPOSURE       13
#define BIND_FRAGMENTS      14
#define BIND_ENVIRONMENT    15
#define BIND_TILES          16
#define BIND_VOXEL_INDEX    17
#define BIND_CELLS          18
#define BIND_SURFELS        19
#define BIND_VOXEL_COUNTERS 20
#define BIND_VOXEL_FREE     21
#define BIND_VOXEL_WORK     22
#define BIND_VOXEL_TILES    23
#define BIND_VOXEL_LISTS    24
#define BIND_VOXEL_SURFACES 25
#define BIND_CACHE_QUEUE    26
#define BIND_INDIRECT       27
#define BIND_FACES          28
#define BIND_CHECK          29 // this and the next: shaders/debug/finite_check.comp only
#define BIND_CHECKED        30
#define STORAGE_BINDINGS    31

// Image units
#define IMAGE_VOXEL_RADIANCE 0

// Texture units
#define UNIT_IDS              0
#define UNIT_DEPTH            1
#define UNIT_SHADOW_MAP       2
#define UNIT_VOXEL_RADIANCE   3
#define UNIT_ENVIRONMENT      4
#define UNIT_COLOR_CLASSES    5
#define UNIT_DATA_CLASSES     10
#define MAX_CLASSES_PER_SPACE 5
#define UNIT_BACKGROUND       15
#define UNIT_BVH_NODES        16
#define UNIT_BVH_TRIANGLES    17
#define UNIT_CHECKED          18

#endif
