// What to draw: plain data, set by the caller.
#ifndef VOXCAST_RENDERER_FRAME_FRAME_PARAMS_H
#define VOXCAST_RENDERER_FRAME_FRAME_PARAMS_H

#include <stdbool.h>
#include <stdint.h>
#include "renderer/settings.h"

enum frame_output {
    FRAME_OUTPUT_YCBCR,  // planar full-range BT.601 Y, Cb, Cr, 4:2:0, tonemapped: JPEG's input
    FRAME_OUTPUT_RGBA8,  // tonemapped sRGB, 4 bytes per pixel
    FRAME_OUTPUT_LINEAR, // 4 floats per pixel: linear Rec.709 radiance in cd/m^2, no exposure
};

struct frame_params {
    struct view_camera camera;
    uint32_t width;
    uint32_t height;
    enum quality quality;
    enum debug_view debug_view;
    uint32_t debug_level;       // voxel level that a debug view shows
    enum voxel_face debug_face; // voxel face that a debug view shows
    enum frame_output output;
    struct render_settings settings;
    bool own_voxels;  // shares no volume with other views, since its settings differ from theirs
    uint64_t user_id; // returned with the pixels
};

#endif
