// Layout of vertices and visibility ids, in C and GLSL.
#ifndef VOXCAST_SHADERS_SHARED_VERTEX_H
#define VOXCAST_SHADERS_SHARED_VERTEX_H

// Visibility id: 1 + (block * 2^ID_BLOCK_BITS + triangle in block); 0 is the background.
#define ID_BLOCK_BITS 7

// A vertex as compute shaders fetch it, in texels of four words: position (3 floats) and normal
// (octahedral, 2 x 16 bits); first coordinates (2 floats), tangent (as the normal; the lowest bit
// of the second half is 1 if the bitangent is flipped); second coordinates; colour (4 floats).
#define VERTEX_TEXELS       4u
#define VERTEX_WORDS        16
#define VERTEX_NORMAL       3
#define VERTEX_UV           4
#define VERTEX_TANGENT      6
#define VERTEX_SECOND_UV    8
#define VERTEX_COLOR        12
#define VERTEX_NO_DIRECTION 0x80008000u // outside the encoding's range

#define MAX_BLENDED_LAYERS 16
#define BLENDED_PER_PIXEL  8

#endif
