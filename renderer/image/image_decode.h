// Decodes image files from memory: PNG, JPEG, TGA, BMP and WebP to 8-bit RGBA, Radiance to floats.
#ifndef VOXCAST_RENDERER_IMAGE_IMAGE_DECODE_H
#define VOXCAST_RENDERER_IMAGE_IMAGE_DECODE_H

#include <stddef.h>

#include "renderer/error.h"
#include "renderer/image/image.h"

// Reads width and height from the header, so that limits are checked before decoding. Detects the
// format by content. False with a message if it is unknown, or the size is zero or above
// SCENE_MAX_IMAGE_EDGE or SCENE_MAX_IMAGE_BYTES. Any thread.
bool image_decode_size(const uint8_t *bytes, size_t size, uint32_t *out_width, uint32_t *out_height,
                       struct error *out_error);

// Decodes an image; the caller owns one reference. NULL with a message on failure. Allocates at
// most a small multiple of the image's size. Any thread.
struct image *image_decode(const uint8_t *bytes, size_t size, struct error *out_error);

// A Radiance HDR image as width x height x 3 linear floats, row 0 at the top, all finite and at
// least 0; the caller frees them. On failure NULL, with outputs unchanged. Any thread.
float *image_decode_radiance(const uint8_t *bytes, size_t size, uint32_t *out_width,
                             uint32_t *out_height, struct error *out_error);

#endif
