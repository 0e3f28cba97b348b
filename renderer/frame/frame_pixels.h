// A finished frame in host memory.
#ifndef VOXCAST_RENDERER_FRAME_FRAME_PIXELS_H
#define VOXCAST_RENDERER_FRAME_FRAME_PIXELS_H

#include "renderer/frame/frame_params.h"

#define RENDERER_FRAMES_IN_RING 3u

// Pictures in host memory. Row 0 at the top. Planes of FRAME_OUTPUT_YCBCR: Y of width x height,
// Cb and Cr of (width+1)/2 x (height+1)/2; other outputs have one plane.
struct frame_pixels {
    uint64_t user_id;
    uint32_t width;
    uint32_t height;
    enum frame_output output;
    const uint8_t *planes[3];
    uint32_t row_pitch_bytes[3];
    uint32_t reference_samples; // per pixel, if the picture is a reference's; else 0
    float reference_noise;      // standard error of a pixel over the mean luminance; 0: unknown
    float convergence;    // 0 to 1: how far indirect light and averaging have come; 1 is final
    double frame_time_ms; // wall time from the call of renderer_view_draw to the pixels being here,
                          // but for that of renderer_params.yield
};

#endif
