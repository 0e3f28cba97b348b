// Displayed pictures made on the CPU from linear radiance: the curves of shaders/lib/display.glsl
// and the automatic exposure of shaders/post/exposure.comp. So pictures of different origin are
// shown and judged alike.
#ifndef VOXCAST_RENDERER_METRICS_DISPLAY_H
#define VOXCAST_RENDERER_METRICS_DISPLAY_H

#include "renderer/metrics/picture.h"
#include "renderer/settings.h"

struct display_params {
    float exposure; // radiance is multiplied by it
    enum tonemap tonemap;
    float gamma; // 0: the sRGB curve (IEC 61966-2-1); else a plain power
};

// The scale that automatic exposure settles on for this picture; 1 if nothing in it shines.
float display_automatic_exposure(const struct picture *picture);

// One pixel's radiance to display values 0..1. What is not finite shows as black.
void display_pixel(const struct display_params *params, const float radiance[3],
                   float out_display[3]);

// A whole picture; `out_picture` is initialised and of the same size, or the same.
void display_picture(const struct display_params *params, const struct picture *radiance,
                     struct picture *out_picture);

// A whole picture to 3 bytes a pixel.
void display_bytes(const struct display_params *params, const struct picture *radiance,
                   uint8_t *out_rgb);

// The sRGB curve backwards: display values 0..1 to linear 0..1.
float display_linear_from_srgb(float value);

#endif
