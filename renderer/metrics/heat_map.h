// Colours for errors of 0 to 1: from black through violet, red and orange to pale yellow. Lightness
// grows linearly, so equal steps of error look equal and a grey print keeps the order.
//
// Computed in OKLab (Ottosson 2020, "A perceptual color space for image processing"): lightness and
// hue are linear in the error; chroma is a half sine, clamped to the sRGB gamut.
#ifndef VOXCAST_RENDERER_METRICS_HEAT_MAP_H
#define VOXCAST_RENDERER_METRICS_HEAT_MAP_H

#include <stddef.h>
#include <stdint.h>

// sRGB of one error; clamps to 0..1, also NaN.
void heat_map_color(float error, uint8_t out_rgb[3]);

// `count` errors to `count` pixels of 3 bytes.
void heat_map_colors(const float *errors, size_t count, uint8_t *out_rgb);

#endif
