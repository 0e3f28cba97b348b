// Colours for errors of 0 to 1: black by violet, red and orange to a pale yellow, with a lightness
// that grows evenly, so that equal steps of error look equal and a print in grey keeps the order.
//
// Computed rather than tabled: in OKLab (Ottosson 2020, "A perceptual color space for image
// processing") lightness is linear in the error and hue turns evenly; chroma is a half sine, and as
// large as the gamut of sRGB allows.
#ifndef VOXCAST_RENDERER_METRICS_HEAT_MAP_H
#define VOXCAST_RENDERER_METRICS_HEAT_MAP_H

#include <stddef.h>
#include <stdint.h>

// sRGB of one error; what is below 0 or above 1, or not a number, is as 0 or 1.
void heat_map_color(float error, uint8_t out_rgb[3]);

// `count` errors to `count` pixels of 3 bytes.
void heat_map_colors(const float *errors, size_t count, uint8_t *out_rgb);

#endif
