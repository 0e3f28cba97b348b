// Decodes image files from memory: PNG, JPEG, TGA, BMP and WebP to 8-bit RGBA.
#ifndef VOXCAST_RENDERER_IMAGE_IMAGE_DECODE_H
#define VOXCAST_RENDERER_IMAGE_IMAGE_DECODE_H

#include <stddef.h>

#include "renderer/error.h"
#include "renderer/image/image.h"

// Width and height from the header alone, so that limits hold before anything is decoded. The
// format is told by the content. False with a message if it is unknown, or the size is zero or
// beyond IMAGE_MAX_EDGE or IMAGE_MAX_BYTES. Any thread.
bool image_decode_size(const uint8_t *bytes, size_t size, uint32_t *out_width, uint32_t *out_height,
                       struct error *out_error);

// Decodes an image; the caller owns one reference. NULL with a message on failure. Allocates at
// most a small multiple of the image's size. Any thread.
struct image *image_decode(const uint8_t *bytes, size_t size, struct error *out_error);

#endif
