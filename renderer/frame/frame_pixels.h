// A finished frame in host memory.
#ifndef VOXCAST_RENDERER_FRAME_FRAME_PIXELS_H
#define VOXCAST_RENDERER_FRAME_FRAME_PIXELS_H

#include "renderer/frame/frame_params.h"

#define RENDERER_FRAMES_IN_RING 3u

// Image in host memory, row 0 at the top. FRAME_OUTPUT_YCBCR has planes Y of width x height, Cb and
// Cr of (width+1)/2 x (height+1)/2; other outputs have one plane.
struct frame_pixels {
    uint64_t user_id;
    uint32_t width;
    uint32_t height;
    enum frame_output output;
    const uint8_t *planes[3];
    uint32_t row_pitch_bytes[3];
    uint32_t reference_samples; // per pixel, if this is a reference; else 0
    float reference_noise;      // standard error of a pixel over the mean luminance; 0: unknown
    float convergence;    // 0 to 1, of indirect light and accumulation; 1: nothing more changes
    double frame_time_ms; // wall time from the call of renderer_view_draw() to these pixels,
                          // without the time spent in renderer_params.yield
};

#endif
