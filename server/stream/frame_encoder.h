// How frames are compressed: one row a codec.
#ifndef VOXCAST_SERVER_STREAM_FRAME_ENCODER_H
#define VOXCAST_SERVER_STREAM_FRAME_ENCODER_H

#include "renderer/renderer.h"

// An image as FRAME_OUTPUT_YCBCR has it: planes of 8 bits, 4:2:0.
struct frame_planes {
    int width, height;
    const uint8_t *planes[3];
    int pitches[3]; // bytes
};

// Whoever encodes has encoders of its own: nothing is shared between threads.
struct frame_encoder {
    void *(*create)(void);         // what is kept between frames; NULL when memory ends
    void (*destroy)(void *memory); // never of NULL

    // Bytes that stay until the next call, and their number in `out_size`. Returns NULL, logged,
    // where it fails. `quality` is 1 to 100.
    const uint8_t *(*encode)(void *memory, const struct frame_planes *image, int quality,
                             size_t *out_size);
};

extern const struct frame_encoder frame_encoder_jpeg;

const struct frame_encoder *frame_encoder_of(enum frame_codec codec);

#endif
