// Shared by the files of renderer/gpu; included nowhere else.
#ifndef VOXCAST_RENDERER_GPU_INTERNAL_H
#define VOXCAST_RENDERER_GPU_INTERNAL_H

#include <epoxy/egl.h>
#include <epoxy/gl.h>
#include <stdatomic.h>

#include "renderer/gpu/gpu.h"

struct gpu_allocation {
    char label[GPU_LABEL_BYTES];
    uint64_t bytes;
    struct gpu_allocation *next;
    struct gpu_allocation **link; // the pointer that points here
};

struct gpu_program_library;

struct gpu {
    EGLDisplay display;
    EGLContext context;
    struct renderer_info info;
    char shader_dir[1024];
    char *shader_defines; // NULL for none
    uint64_t error_count;
    struct gpu_allocation *allocations;
    struct gpu_program_library *programs;
    uint32_t current_program;
    uint64_t programs_built;
    void (*yield)(void *user); // NULL for none
    void *yield_user;
    double waited_ms;                      // in `yield`, so far
    uint64_t faults[RENDERER_FAULT_COUNT]; // events left until the one that fails; 0: none
    bool lost;
    bool pinned_memory; // buffers can lie in memory of ours (GL_AMD_pinned_memory)
};

void gpu_account(struct gpu *gpu, struct gpu_allocation *allocation, const char *label,
                 uint64_t bytes);
void gpu_unaccount(struct gpu_allocation *allocation);

// Counts an event. True if this one must fail.
bool gpu_fault_strikes(struct gpu *gpu, enum renderer_fault fault);

// True, once, if GL ran out of memory in the calls since the last check, which created one buffer
// or texture.
bool gpu_take_out_of_memory(struct gpu *gpu);

// EGL half of gpu_create(), in egl_context.c.
bool gpu_egl_open(struct gpu *gpu, const char *choice, struct error *out_error);
void gpu_egl_close(struct gpu *gpu);

#endif
