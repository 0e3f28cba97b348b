// Linear radiance to display values on the CPU: the curves of shaders/lib/display.glsl and the
// automatic exposure of shaders/post/exposure.comp, so that images of any origin are shown and
// judged alike.
#ifndef VOXCAST_RENDERER_METRICS_DISPLAY_H
#define VOXCAST_RENDERER_METRICS_DISPLAY_H

#include "renderer/metrics/picture.h"
#include "renderer/settings.h"

struct display_params {
    float exposure; // factor on radiance
    enum tonemap tonemap;
    float gamma; // 0: the sRGB curve (IEC 61966-2-1); else a plain power
};

// Scale that automatic exposure converges to for this image; 1 if the image is black.
float display_automatic_exposure(const struct picture *picture);

// One pixel's radiance to display values 0..1. Non-finite values become black.
void display_pixel(const struct display_params *params, const float radiance[3],
                   float out_display[3]);

// A whole image; `out_picture` is initialised and of the same size, or the input itself.
void display_picture(const struct display_params *params, const struct picture *radiance,
                     struct picture *out_picture);

// A whole image to 3 bytes per pixel.
void display_bytes(const struct display_params *params, const struct picture *radiance,
                   uint8_t *out_rgb);

// Inverse sRGB curve: display values 0..1 to linear 0..1.
float display_linear_from_srgb(float value);

#endif
