// A small JPEG of a texture, as base64 text.
#ifndef VOXCAST_SERVER_STREAM_THUMBNAIL_H
#define VOXCAST_SERVER_STREAM_THUMBNAIL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "renderer/image/image.h"

struct thumbnail {
    uint32_t width; // the longer edge is at most PROTOCOL_MAX_THUMBNAIL_EDGE
    uint32_t height;
    char *base64; // owned
};

// Averages up to 8 x 8 texels for each pixel, so that the cost is bounded for any image. False when
// out of memory.
bool thumbnail_create(struct image *image, struct thumbnail *out_thumbnail);
void thumbnail_finish(struct thumbnail *thumbnail);

// RFC 4648 text from malloc, owned by the caller; NULL when out of memory.
char *base64_encode(const uint8_t *bytes, size_t count);

#endif
