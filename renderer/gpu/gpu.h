// The headless GL 4.5 context and the commands that passes issue. Render thread only.
//
// renderer/gpu/ is the only folder that calls EGL or GL.
#ifndef VOXCAST_RENDERER_GPU_GPU_H
#define VOXCAST_RENDERER_GPU_GPU_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "renderer/error.h"
#include "renderer/gpu/gpu_info.h"

#define GPU_LABEL_BYTES 32u // of an object's label, with its terminator

struct gpu;
struct gpu_buffer;
struct gpu_texture;
struct gpu_program;
struct gpu_framebuffer;

// Sets what a CPU driver and its malloc() read from the environment, unless it is set; where
// malloc() must know it from the start, executes the program anew with main()'s `arguments`. Call
// first.
void gpu_prepare_process(char *const arguments[]);

// `gpu` is "auto", "software" or a device index. On failure the message names what is missing.
struct gpu *gpu_create(const char *gpu, const char *shader_dir, struct error *out_error);
void gpu_destroy(struct gpu **gpu);
const struct renderer_info *gpu_get_info(const struct gpu *gpu);
const char *gpu_get_shader_dir(const struct gpu *gpu);

// Implements renderer_inject_fault() and renderer_fault_left().
void gpu_inject_fault(struct gpu *gpu, enum renderer_fault fault, uint64_t number);
uint64_t gpu_fault_left(const struct gpu *gpu, enum renderer_fault fault);

// Whether the driver has lost the context and everything in it: nothing can be drawn any more.
// Queries the driver.
bool gpu_is_lost(struct gpu *gpu);

// Errors that the debug callback has reported so far, and those that were counted.
uint64_t gpu_error_count(const struct gpu *gpu);

// Counts a misuse of the GPU that GL does not see as an error; the caller logs it.
void gpu_count_error(struct gpu *gpu);

// Live buffers and textures whose labels are equal up to the first dot.
struct gpu_memory_group {
    char name[GPU_LABEL_BYTES];
    uint64_t bytes;
};

// All of them by name, sorted. Returns their number, at most `capacity`.
uint32_t gpu_memory_groups(const struct gpu *gpu, struct gpu_memory_group *out_groups,
                           uint32_t capacity);

// Calls `yield`, which may block, before each dispatch or immediate draw. On CPU drivers only: they
// run work of all contexts in sequence, so a frame of many long dispatches would hold up all
// others; GPUs finish a frame before that matters. NULL: never called, as after gpu_create().
void gpu_set_yield(struct gpu *gpu, void (*yield)(void *user), void *user);

// A clock that stops while `yield` blocks.
double gpu_clock_ms(const struct gpu *gpu);

// Debug groups, shown in captures and debug messages.
void gpu_push_group(struct gpu *gpu, const char *name);
void gpu_pop_group(struct gpu *gpu);

// What a texel of a buffer texture is.
enum gpu_texel {
    GPU_TEXEL_UINT,
    GPU_TEXEL_UINT3,
    GPU_TEXEL_UINT4,
    GPU_TEXEL_FLOAT4,
    GPU_TEXEL_COUNT
};

// Bindings; slots are those of shaders/shared/slots.h.
void gpu_bind_storage(struct gpu *gpu, uint32_t slot, const struct gpu_buffer *buffer);
void gpu_bind_uniforms(struct gpu *gpu, uint32_t slot, const struct gpu_buffer *buffer);
void gpu_bind_texture(struct gpu *gpu, uint32_t slot, const struct gpu_texture *texture);

// Binds a buffer to a texture unit, as texels that shaders fetch by number: on a CPU four words
// cost a twentieth of what they cost from a storage block. Fetches of what the same dispatch writes
// are not ordered.
void gpu_bind_texels(struct gpu *gpu, uint32_t unit, const struct gpu_buffer *buffer,
                     enum gpu_texel texel);

// Whether shaders can reach all of a buffer of this size by texels; the driver sets a limit.
bool gpu_texels_fit(const struct gpu *gpu, enum gpu_texel texel, uint64_t size_bytes);
void gpu_bind_image(struct gpu *gpu, uint32_t slot, const struct gpu_texture *texture);

// Dispatches x * y * z groups of a compute program.
void gpu_dispatch(struct gpu *gpu, const struct gpu_program *program, uint32_t x, uint32_t y,
                  uint32_t z);

// The same with the three counts read from a buffer that a shader wrote.
void gpu_dispatch_indirect(struct gpu *gpu, const struct gpu_program *program,
                           const struct gpu_buffer *arguments, size_t offset_bytes);

// Makes writes of earlier commands visible to all later ones.
void gpu_barrier(struct gpu *gpu);

enum gpu_cull { GPU_CULL_NONE, GPU_CULL_BACK, GPU_CULL_FRONT };
enum gpu_depth_test { GPU_DEPTH_GREATER_WRITE, GPU_DEPTH_GREATER_READ };

struct gpu_raster_params {
    const struct gpu_framebuffer *framebuffer;
    uint32_t width;
    uint32_t height;
    bool clear; // colour to 0 (integers), depth to 0 (far plane of reversed Z)
    enum gpu_depth_test depth_test;
    float depth_bias_slope; // glPolygonOffset in reversed Z: negative pushes away
    float depth_bias_constant;
};

void gpu_begin_raster(struct gpu *gpu, const struct gpu_raster_params *params);
void gpu_end_raster(struct gpu *gpu);

// GL's DrawElementsIndirectCommand; base_instance selects the draw's record.
struct gpu_draw {
    uint32_t index_count;
    uint32_t instance_count;
    uint32_t index_first;
    int32_t base_vertex;
    uint32_t base_instance;
};

// Per-draw vertex attributes: the rows of clip_from_local (attributes 2 to 5), and first visibility
// id and material (attribute 8). For a software renderer attributes that change once per draw cost
// far less than look-ups in a storage buffer.
struct gpu_draw_record {
    float clip_rows[4][4];
    uint32_t first_id;
    uint32_t material;
    uint32_t unused[2];
};

// A vertex as rasterised: attributes 0 (position), 1 (both sets of texture coordinates), 6 (alpha)
// and 7 (number of the triangles that start with this vertex).
struct raster_vertex {
    float position[3];
    float uv[2][2];
    float alpha;
    uint32_t triangle;
};

// `vertices` holds raster_vertex, `indices` 32-bit indices.
struct gpu_geometry;
struct gpu_geometry *gpu_geometry_create(struct gpu *gpu, const struct gpu_buffer *vertices,
                                         const struct gpu_buffer *indices);
void gpu_geometry_destroy(struct gpu_geometry **geometry);

// Draws `count` commands of `draws` from number `first` on. `records` holds gpu_draw_record.
struct gpu_draw_params {
    const struct gpu_program *program;
    const struct gpu_geometry *geometry;
    const struct gpu_buffer *draws;
    const struct gpu_buffer *records;
    uint32_t first;
    uint32_t count;
    enum gpu_cull cull;
};
void gpu_draw_indirect(struct gpu *gpu, const struct gpu_draw_params *params);

// Fences signal when all commands before them are done.
struct gpu_fence;
struct gpu_fence *gpu_fence_create(struct gpu *gpu);
bool gpu_fence_is_done(struct gpu_fence *fence, bool wait);
void gpu_fence_destroy(struct gpu_fence **fence);

#endif
