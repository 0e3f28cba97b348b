// GPU buffers with immutable storage.
#ifndef VOXCAST_RENDERER_GPU_BUFFER_H
#define VOXCAST_RENDERER_GPU_BUFFER_H

#include "renderer/gpu/gpu.h"

enum gpu_buffer_kind {
    GPU_BUFFER_STATIC,   // written by gpu_buffer_write() or by shaders
    GPU_BUFFER_READBACK, // mapped for reading throughout its life
};

// Smaller sizes are raised to this, so that the buffer can be bound.
#define GPU_BUFFER_MIN_BYTES 16u

// `label` becomes the GL object label; see gpu_memory_groups(). Contents start as `data`, or zero.
// NULL when GL runs out of memory.
struct gpu_buffer *gpu_buffer_create(struct gpu *gpu, const char *label, enum gpu_buffer_kind kind,
                                     size_t size_bytes, const void *data);
void gpu_buffer_destroy(struct gpu_buffer **buffer);
size_t gpu_buffer_size_bytes(const struct gpu_buffer *buffer);
void gpu_buffer_write(struct gpu_buffer *buffer, size_t offset_bytes, size_t size_bytes,
                      const void *data);
void gpu_buffer_clear(struct gpu_buffer *buffer);
void gpu_buffer_fill(struct gpu_buffer *buffer, size_t offset_bytes, size_t size_bytes,
                     uint32_t value);
void gpu_buffer_copy(struct gpu_buffer *target, size_t target_offset_bytes,
                     const struct gpu_buffer *source, size_t source_offset_bytes,
                     size_t size_bytes);

// Copies bytes to host memory; waits for the GPU. For tests and small results.
void gpu_buffer_read(const struct gpu_buffer *buffer, size_t offset_bytes, size_t size_bytes,
                     void *out_data);

// Mapping of a GPU_BUFFER_READBACK; valid once a fence after the copy has signalled.
const void *gpu_buffer_mapping(const struct gpu_buffer *buffer);

// Keeps the buffer if it is large enough, else replaces it. False when out of memory (*buffer is
// then NULL).
bool gpu_buffer_ensure(struct gpu *gpu, struct gpu_buffer **buffer, const char *label,
                       enum gpu_buffer_kind kind, size_t size_bytes);

uint32_t gpu_buffer_name(const struct gpu_buffer *buffer);

// The buffer as a buffer texture; made at the first call, and destroyed with the buffer.
uint32_t gpu_buffer_texture_name(struct gpu_buffer *buffer, enum gpu_texel texel);

#endif
