// What the driver is, and the faults that tests inject into it.
#ifndef VOXCAST_RENDERER_GPU_GPU_INFO_H
#define VOXCAST_RENDERER_GPU_GPU_INFO_H

#include <stdbool.h>
#include <stdint.h>

struct renderer_info {
    char gl_renderer[128];
    char gl_version[128];
    char egl_device[128];
    bool software;   // llvmpipe or another CPU rasteriser
    bool gpu_timers; // timer queries can be trusted for compute dispatches
    uint32_t max_texture_edge;
};

// Faults of drivers and machines, for tests.
enum renderer_fault {
    RENDERER_FAULT_ALLOCATION, // of a buffer or texture: there is no more memory
    RENDERER_FAULT_PROGRAM,    // of compiling shaders
    RENDERER_FAULT_CONTEXT,    // of drawing a frame: the context is lost
    RENDERER_FAULT_COUNT
};

#endif
