// Buffers of the search for NaN and infinity, in C and GLSL; std430.
#ifndef VOXCAST_SHADERS_SHARED_FINITE_CHECK_H
#define VOXCAST_SHADERS_SHARED_FINITE_CHECK_H

#include "shared/types.h"

// TEXTURE of debug/finite_check.comp: what is checked.
#define CHECK_BUFFER        0
#define CHECK_TEXTURE_2D    1
#define CHECK_TEXTURE_ARRAY 2
#define CHECK_TEXTURE_3D    3

// Of one dispatch.
struct finite_check_shape {
    uint length; // in words or texels
    uint record_words;
    uint result; // index of the result to write
    uint texture_level;
};

// Words of a record that are floats, or that hold a half in the low or high bits; the last bit
// stands for the remaining words.
struct finite_check_masks {
    uint floats;
    uint low_halves;
    uint high_halves;
    uint first_word; // of the buffer
};

struct finite_check_result {
    uint count; // of NaN and infinity
    uint first; // in words or texels
    uint unused_0;
    uint unused_1;
};

#endif
