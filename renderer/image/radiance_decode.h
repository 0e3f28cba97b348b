// Decodes Radiance (.hdr) images from memory: flat texels and both kinds of run lengths.
#ifndef VOXCAST_RENDERER_IMAGE_RADIANCE_DECODE_H
#define VOXCAST_RENDERER_IMAGE_RADIANCE_DECODE_H

#include <stddef.h>
#include <stdint.h>

#include "renderer/error.h"

// Width x height x 3 linear floats, finite and at least 0, row 0 at the top; the caller frees them.
// NULL, with untouched outputs and a message that says what is wrong and what is allowed, on
// failure. Size is checked before anything is allocated. Any thread.
float *radiance_decode(const uint8_t *bytes, size_t size, uint32_t *out_width, uint32_t *out_height,
                       struct error *out_error);

#endif
