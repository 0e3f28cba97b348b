// Decodes OpenEXR images from memory: one part of scanlines or tiles with channels R, G, B or Y, as
// half or float.
#ifndef VOXCAST_RENDERER_IMAGE_EXR_DECODE_H
#define VOXCAST_RENDERER_IMAGE_EXR_DECODE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "renderer/error.h"

#define EXR_MAX_CHANNELS 64

// Whether the bytes begin as an OpenEXR file does.
bool exr_is_exr(const uint8_t *bytes, size_t size);

// Width x height x 3 linear floats as the file has them, so maybe not finite; row 0 at the top; the
// caller frees them. NULL, with untouched outputs and a message that says what is wrong and what is
// allowed, on failure. Size and channels are checked before anything is allocated for them. Any
// thread.
float *exr_decode(const uint8_t *bytes, size_t size, uint32_t *out_width, uint32_t *out_height,
                  struct error *out_error);

#endif
