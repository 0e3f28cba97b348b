// Layouts of the voxel buffers, in C and GLSL. ARCHITECTURE.md describes their use.
#ifndef VOXCAST_SHADERS_SHARED_VOXEL_RECORDS_H
#define VOXCAST_SHADERS_SHARED_VOXEL_RECORDS_H

#include "shared/voxel_block.h"

// A voxel's word in the index: 0 empty; 1 + cell; while geometry is being added, the first surfel
// with this tag.
#define VOXEL_TAG_SURFEL 0x80000000u
#define VOXEL_NONE       0xffffffffu

// A cell is an occupied voxel. Word 0: slot in its level | level << 28, or VOXEL_NONE; word 1:
// first surfel; then per face 1 + face record, or 0 without a surface.
#define CELL_WORDS     8u
#define CELL_SURFEL    1u
#define CELL_FACES     2u
#define CELL_LEVEL_BIT 28
#define CELL_SLOT_MASK 0x0fffffffu

// A face record caches the irradiance of a voxel face that has a surface. After these words comes
// one per cone: where it hits, how much it transmits and its diameter there, as add_cone() of
// shaders/lib/cone_hemisphere.glsl packs them. While geometry is unchanged, updating a cone costs
// one look-up. Records are whole texels of four words; words that are read together share one.
#define FACE_WORDS  12u // without the cones
#define FACE_NORMAL 0u  // mean, octahedral, 2 x 16 bits; VOXEL_NONE: surface removed
#define FACE_SHOWN  1u  // two words: smoothed irradiance, as FACE_LIGHT
#define FACE_STATE  3u  // generation (16 bits) | change << 16 (6 bits) | flags | epoch << 24
#define FACE_LIGHT                                                                                 \
    4u // two words: irradiance / pi / scale as 3 halves, ambient visibility as a half
#define FACE_SUB_VOXEL_POSITION  6u  // mean position in the voxel, 3 x 10 bits; FACE_THIN
#define FACE_REQUEST             7u  // frame of the newest request
#define FACE_DIRECT              8u  // two words: radiance but for bounces / scale, optical depth
#define FACE_ALBEDO              10u // reflectance, 3 x 10 bits
#define FACE_CELL                11u // cell * 8 + face
#define FACE_RECORD_WORDS(cones) ((FACE_WORDS + (cones) + 3u) & ~3u)
#define FACE_VALID               0x400000u   // FACE_LIGHT is valid
#define FACE_MARCHED             0x800000u   // the cones' hits are valid; epoch: for which geometry
#define FACE_THIN                0x40000000u // of no thickness: its back is in this voxel, too
#define FACE_CHANGE_BIT          16
#define FACE_EPOCH_BIT           24

// A surfel sums what one surface has in a voxel, for triangles of the same dominant axis and side
// (0 to 5, as faces). Integer sums do not depend on the triangles' order.
#define SURFEL_WORDS              18u
#define SURFEL_NEXT               0u
#define SURFEL_KEY                1u // surface * 8 + face
#define SURFEL_MASK               2u // bit x + 2 y + 4 z for each half of the voxel in use
#define SURFEL_WEIGHT             3u
#define SURFEL_NORMAL             4u    // 3 sums of weight * normal * 127
#define SURFEL_SUB_VOXEL_POSITION 7u    // 3 sums of weight * position in the voxel * 255
#define SURFEL_OPACITY            10u   // sum of weight * alpha * 255
#define SURFEL_COLOR              11u   // 3 sums of weight * base colour texture * 255
#define SURFEL_EMISSION           14u   // 3 sums of weight * emissive texture * 255
#define SURFEL_WEIGHT_SCALE       512.0 // weight per squared voxel edge; at least 1 per triangle
// Maximum weight of a surfel: 255 times as much fits into 31 bits. By then more than 15,000
// triangles that cross the whole voxel have formed the mean.
#define SURFEL_WEIGHT_MAX 8000000u

// Words of the counters. Then COUNTER_LIST_WORDS per list: groups x, y, z of an indirect dispatch
// and the number of entries.
#define COUNTER_CELLS            0
#define COUNTER_FREE_CELLS       1
#define COUNTER_SURFELS          2
#define COUNTER_FREE_SURFELS     3
#define COUNTER_RETURNED_SURFELS 4
#define COUNTER_OVERFLOW         5 // OVERFLOW_ bits
#define COUNTER_CLAMPED          6 // values that half floats cannot hold, since creation
#define COUNTER_CACHE_LEFT       7 // stale faces left by the newest selection
#define COUNTER_CACHE_CHANGE     8 // largest relative change of a face in this generation (float)
#define COUNTER_CACHE_TRACED     9
#define COUNTER_CACHE_PEAK       10 // largest luminance of a face in this generation (float)
#define COUNTER_TILES            12 // arguments of voxelizing large triangles
#define COUNTER_MARCH            16 // arguments of tracing cones; number of faces
#define COUNTER_LOOKUP           20 // the same for look-ups at the hits
#define COUNTER_CACHE_CLASSES    24 // faces per class of urgency
#define COUNTER_FACES            30
#define COUNTER_FREE_FACES       31
#define COUNTER_LISTS            32
#define OVERFLOW_POOLS           1u
#define OVERFLOW_FACES           2u
#define COUNTER_LIST_WORDS       4
#define COUNTER_COUNT            (COUNTER_LISTS + VOXEL_MAX_LEVELS * COUNTER_LIST_WORDS)

// Classes of faces to march: requested and new, requested, others. Then of faces to look up:
// requested and changing much, requested, others.
#define CACHE_CLASSES       6u
#define CACHE_MARCH_CLASSES 3u
// Marching a face costs as much as so many look-ups.
#define CACHE_MARCH_COST 10u

// STAGE of voxel/voxel_lists.comp.
#define LISTS_RESET          0 // repairs the lengths of the free lists and empties the lists
#define LISTS_APPEND         1 // enters cells and mip voxels
#define LISTS_ARGUMENTS      2 // lengths become arguments of indirect dispatches
#define LISTS_TILE_ARGUMENTS 3 // likewise for the tiles of large triangles

// STAGE of gi/cache_select.comp.
#define SELECT_FACES     0 // enqueues faces by class of urgency
#define SELECT_ARGUMENTS 1 // arguments of the passes over them

// List 0 has the cells that are lit, of all levels; list n the voxels of level n that are filtered
// from the finer level.
#define LIST_LIT 0

#define SURFACE_MATERIAL_MASK 0x0fffffffu
#define SURFACE_LIT_DIRECTLY  0x80000000u // sampled directly as a planar emitter

#endif
