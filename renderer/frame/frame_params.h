// What a frame is to show: plain data, set by whoever asks for it.
#ifndef VOXCAST_RENDERER_FRAME_FRAME_PARAMS_H
#define VOXCAST_RENDERER_FRAME_FRAME_PARAMS_H

#include <stdbool.h>
#include <stdint.h>
#include "renderer/settings.h"

enum frame_output {
    FRAME_OUTPUT_YCBCR,  // planar full-range BT.601 Y, Cb, Cr, 4:2:0, tonemapped: what JPEG wants
    FRAME_OUTPUT_RGBA8,  // tonemapped sRGB, 4 bytes a pixel
    FRAME_OUTPUT_LINEAR, // 4 floats a pixel: linear Rec.709 radiance in cd/m^2, no exposure
};

struct frame_params {
    struct view_camera camera;
    uint32_t width;
    uint32_t height;
    enum quality quality;
    enum debug_view debug_view;
    uint32_t debug_level;       // of the voxels that a debug view shows
    enum voxel_face debug_face; // likewise
    enum frame_output output;
    struct render_settings settings;
    bool own_voxels;  // shares none with other views, since its settings are not theirs
    uint64_t user_id; // handed back with the pixels
};

#endif
