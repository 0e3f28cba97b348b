// Binding numbers, group sizes and limits: stated once for C and GLSL.
#ifndef VOXCAST_SHADERS_SHARED_BINDINGS_H
#define VOXCAST_SHADERS_SHARED_BINDINGS_H

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
#define BIND_CHECK          29 // of shaders/debug/finite_check.comp alone, likewise the next
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
#define UNIT_TREE_NODES       16
#define UNIT_TREE_TRIANGLES   17
#define UNIT_CHECKED          18

// A tree of boxes over the scene's triangles, for rays: TREE_NODE_TEXELS texels of 4 words a node
// and TREE_TRIANGLE_TEXELS a triangle, in rows of 2^TREE_ROW_BITS texels. A node has for each of
// two children lower corner and child, upper corner. A child is a node, or TREE_LEAF | first
// triangle << TREE_COUNT_BITS | triangles. A triangle has its first corner and visibility id, then
// an edge from there and mean opacity, then the other edge and flags.
#define TREE_ROW_BITS        12
#define TREE_NODE_TEXELS     4
#define TREE_TRIANGLE_TEXELS 3
#define TREE_LEAF            0x80000000u
#define TREE_COUNT_BITS      3
#define TREE_MAX_DEPTH       48
#define TREE_LIT_DIRECTLY    1u // its emission reaches others as a planar emitter's
#define TREE_ONE_SIDED       2u // stops light on its back, but sends none

// Pictures of what rays from pixels have found, 4 floats a pixel: sums of irradiance / pi / scale
// and openness; their means; sums of what lobes mirror, in cd/m^2 times the share that is
// reflected, and of those shares; their quotients. The latter two only where there is gloss.
#define GATHERED_LIGHT         0
#define GATHERED_LIGHT_MEANS   1
#define GATHERED_GLOSS         2
#define GATHERED_GLOSS_MEANS   3
#define GATHERED_WITHOUT_GLOSS 2
#define GATHERED_PICTURES      4

// Work groups
#define GROUP_EDGE            8
#define LIGHT_TILE_EDGE       16
#define ENVIRONMENT_BRDF_EDGE 16 // nodes of its table in roughness and in sqrt(n.v)
#define LINEAR_GROUP          64
#define HISTOGRAM_BINS        128

// A visibility id is 1 + (block * 2^ID_BLOCK_BITS + triangle in block): 0 is the background.
#define ID_BLOCK_BITS 7

// Words of a vertex as compute shaders read it: position 0 (3 floats), normal 3 (octahedral, 2 x 16
// bits), tangent 4 (the same; the lowest bit of the second half is 1 where the bitangent is
// reversed), coordinates 5 (2 x 2 floats), colour 9 (4 floats).
#define VERTEX_WORDS        13
#define VERTEX_NORMAL       3u
#define VERTEX_TANGENT      4u
#define VERTEX_UV           5u
#define VERTEX_NO_DIRECTION 0x80008000u // beyond what the encoding uses
#define VERTEX_COLOR        9u

#define NO_SHADOW 0xffffffffu

// Cube faces and spots see a little more than they need, for the filter's taps at the rim.
#define SHADOW_FACE_MARGIN 1.02f

// A lamp is never nearer to what it lights than this share of the scene's diagonal, nor than so
// many metres where that is more: its light would have no end.
#define LAMP_LEAST_SHARE 1e-4f
#define LAMP_LEAST_M     1e-3f

#define MAX_AREA_LIGHTS    16
#define MAX_SHADOW_LAYERS  32
#define MAX_CASCADES       3
#define MAX_BLENDED_LAYERS 16
#define BLENDED_PER_PIXEL  8

// instance.info.w and material flags
#define INSTANCE_MIRRORED 1u

#define LIGHT_DIRECTIONAL 0
#define LIGHT_POINT       1
#define LIGHT_SPOT        2

#define SHADE_PBR         0u
#define SHADE_BLINN_PHONG 1u
#define SHADE_UNLIT       2u
#define SHADE_BACKGROUND  3u

#define MATERIAL_SHADING_MASK 3u
#define MATERIAL_ALPHA_MASK   8u
#define MATERIAL_ALPHA_BLEND  16u
#define MATERIAL_DOUBLE_SIDED 32u
#define MATERIAL_IOR_ONE      64u // no dielectric reflection at any angle

#define TEXTURE_SLOTS              8
#define TEXTURE_BASE_COLOR         0u
#define TEXTURE_METALLIC_ROUGHNESS 1u
#define TEXTURE_NORMAL             2u
#define TEXTURE_OCCLUSION          3u
#define TEXTURE_EMISSIVE           4u
#define TEXTURE_TRANSMISSION       5u
#define TEXTURE_SPECULAR           6u
#define TEXTURE_SPECULAR_COLOR     7u

#define COLOR_TEXTURE_SLOTS 0x91u // base colour, emissive, specular colour

// texture.info.x: flags, wrap modes (two bits each: 0 repeat, 1 clamp, 2 mirror), log2 of the edge,
// class, layer
#define TEXTURE_UV_SET_1   1u
#define TEXTURE_NEAREST    2u
#define TEXTURE_WRAP_U_BIT 2
#define TEXTURE_WRAP_V_BIT 4
#define TEXTURE_EDGE_BIT   8
#define TEXTURE_CLASS_BIT  12
#define TEXTURE_LAYER_BIT  16

#endif
