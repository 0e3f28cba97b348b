// Driver information, and the faults that tests inject.
#ifndef VOXCAST_RENDERER_GPU_GPU_INFO_H
#define VOXCAST_RENDERER_GPU_GPU_INFO_H

#include <stdbool.h>
#include <stdint.h>

struct renderer_info {
    char gl_renderer[128];
    char gl_version[128];
    char egl_device[128];
    bool software;   // llvmpipe or another CPU rasteriser
    bool gpu_timers; // timer queries are reliable for compute dispatches
    uint32_t max_texture_edge;
    uint32_t max_buffer_texels;
};

// Faults of drivers and machines, for tests.
enum renderer_fault {
    RENDERER_FAULT_ALLOCATION, // out of memory when creating a buffer or texture
    RENDERER_FAULT_PROGRAM,    // shader compilation fails
    RENDERER_FAULT_CONTEXT,    // context lost when drawing a frame
    RENDERER_FAULT_COUNT
};

#endif
