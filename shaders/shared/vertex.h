// Layout of vertices and visibility ids, in C and GLSL.
#ifndef VOXCAST_SHADERS_SHARED_VERTEX_H
#define VOXCAST_SHADERS_SHARED_VERTEX_H

// Visibility id: 1 + (block * 2^ID_BLOCK_BITS + triangle in block); 0 is the background.
#define ID_BLOCK_BITS 7

// Words of a vertex as compute shaders read it: position 0 (3 floats), normal 3 (octahedral, 2 x 16
// bits), tangent 4 (the same; the lowest bit of the second half is 1 if the bitangent is flipped),
// coordinates 5 (2 x 2 floats), colour 9 (4 floats).
#define VERTEX_WORDS        13
#define VERTEX_NORMAL       3u
#define VERTEX_TANGENT      4u
#define VERTEX_UV           5u
#define VERTEX_NO_DIRECTION 0x80008000u // outside the encoding's range
#define VERTEX_COLOR        9u

#define MAX_BLENDED_LAYERS 16
#define BLENDED_PER_PIXEL  8

#endif
