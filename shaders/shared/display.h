// Exposure and output of a frame, for C and GLSL.
#ifndef VOXCAST_SHADERS_SHARED_DISPLAY_H
#define VOXCAST_SHADERS_SHARED_DISPLAY_H

#define HISTOGRAM_BINS 128

// STAGE of post/exposure.comp.
#define EXPOSURE_HISTOGRAM 0 // counts log2 luminances
#define EXPOSURE_MEAN      1 // one group: the mean between two percentiles becomes the scale

// OUTPUT of post/tonemap.comp: enum frame_output.
#define OUTPUT_YCBCR  0
#define OUTPUT_RGBA8  1
#define OUTPUT_LINEAR 2

// ADDED_TO of light/direct_light.comp.
#define ADDED_TO_RADIANCE 0 // what the environment pass wrote
#define ADDED_TO_EMISSION 1
#define ADDED_TO_NOTHING  2 // the debug view of direct light

#endif
