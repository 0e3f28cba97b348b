#include "renderer/gpu/buffer.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "renderer/gpu/internal.h"

// Smaller buffers stay with the driver: a mapping takes whole pages.
#define PINNED_MIN_BYTES (64u << 10)
// CPU drivers read whole vectors, past a buffer's end.
#define PINNED_SLACK_BYTES 256u
// Below that, huge pages would take more than they save.
#define HUGE_PAGES_MIN_BYTES (8u << 20)

struct gpu_buffer {
    struct gpu_allocation allocation;
    GLuint name;
    size_t size_bytes;
    const void *mapping;
    void *pinned; // memory of ours that the buffer lies in; NULL: the driver's
    size_t pinned_bytes;
    GLuint textures[GPU_TEXEL_COUNT]; // the buffer as texels; 0 until needed
};

// Memory of zeros for a buffer. Until it is written it takes none, and no time: llvmpipe writes all
// of a buffer of its own, 3 ms a MiB where the kernel has to find new pages.
static bool map_pinned(struct gpu_buffer *buffer)
{
    size_t page = (size_t)sysconf(_SC_PAGESIZE);
    size_t bytes = (buffer->size_bytes + PINNED_SLACK_BYTES + page - 1) / page * page;
    void *memory = mmap(NULL, bytes, PROT_READ | PROT_WRITE,
                        MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (memory == MAP_FAILED)
        return false;
    if (bytes >= HUGE_PAGES_MIN_BYTES)
        madvise(memory, bytes, MADV_HUGEPAGE); // fails where the kernel has none, which is fine
    buffer->pinned = memory;
    buffer->pinned_bytes = bytes;
    return true;
}

// Storage in memory of ours. False, and the buffer has none, where it is left to the driver.
static bool create_pinned(struct gpu *gpu, struct gpu_buffer *buffer, const void *data,
                          size_t data_bytes)
{
    if (!gpu->pinned_memory || buffer->size_bytes < PINNED_MIN_BYTES || !map_pinned(buffer))
        return false;
    if (data)
        memcpy(buffer->pinned, data, data_bytes);
    glBindBuffer(GL_EXTERNAL_VIRTUAL_MEMORY_BUFFER_AMD, buffer->name);
    glBufferStorage(GL_EXTERNAL_VIRTUAL_MEMORY_BUFFER_AMD, (GLsizeiptr)buffer->size_bytes,
                    buffer->pinned, GL_DYNAMIC_STORAGE_BIT);
    glBindBuffer(GL_EXTERNAL_VIRTUAL_MEMORY_BUFFER_AMD, 0);
    return true;
}

// Storage of the driver's: `data`, then zeros.
static void create_storage(struct gpu_buffer *buffer, GLbitfield flags, const void *data,
                           size_t data_bytes)
{
    bool whole = data && data_bytes == buffer->size_bytes;
    glNamedBufferStorage(buffer->name, (GLsizeiptr)buffer->size_bytes, whole ? data : NULL, flags);
    if (!whole)
        gpu_buffer_clear(buffer);
    if (data && !whole && data_bytes > 0)
        gpu_buffer_write(buffer, 0, data_bytes, data);
}

struct gpu_buffer *gpu_buffer_create(struct gpu *gpu, const char *label, enum gpu_buffer_kind kind,
                                     size_t size_bytes, const void *data)
{
    struct gpu_buffer *buffer = calloc(1, sizeof(*buffer));
    if (!buffer)
        return NULL;
    buffer->size_bytes = size_bytes < GPU_BUFFER_MIN_BYTES ? GPU_BUFFER_MIN_BYTES : size_bytes;
    gpu_account(gpu, &buffer->allocation, label, buffer->size_bytes);
    glCreateBuffers(1, &buffer->name);
    GLbitfield flags = GL_DYNAMIC_STORAGE_BIT;
    if (kind == GPU_BUFFER_READBACK)
        flags |=
            GL_MAP_READ_BIT | GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT | GL_CLIENT_STORAGE_BIT;
    if (kind == GPU_BUFFER_READBACK || !create_pinned(gpu, buffer, data, size_bytes))
        create_storage(buffer, flags, data, size_bytes);
    if (gpu_take_out_of_memory(gpu))
        goto fail;
    glObjectLabel(GL_BUFFER, buffer->name, -1, label);
    if (kind == GPU_BUFFER_READBACK) {
        buffer->mapping =
            glMapNamedBufferRange(buffer->name, 0, (GLsizeiptr)buffer->size_bytes,
                                  GL_MAP_READ_BIT | GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT);
        if (!buffer->mapping)
            goto fail;
    }
    return buffer;
fail:
    gpu_buffer_destroy(&buffer);
    return NULL;
}

void gpu_buffer_destroy(struct gpu_buffer **buffer_slot)
{
    struct gpu_buffer *buffer = *buffer_slot;
    *buffer_slot = NULL;
    if (!buffer)
        return;
    glDeleteTextures(GPU_TEXEL_COUNT, buffer->textures);
    glDeleteBuffers(1, &buffer->name);
    if (buffer->pinned) {
        glFinish(); // draws may still read it
        munmap(buffer->pinned, buffer->pinned_bytes);
    }
    gpu_unaccount(&buffer->allocation);
    free(buffer);
}

size_t gpu_buffer_size_bytes(const struct gpu_buffer *buffer)
{
    return buffer->size_bytes;
}

void gpu_buffer_write(struct gpu_buffer *buffer, size_t offset_bytes, size_t size_bytes,
                      const void *data)
{
    assert(offset_bytes + size_bytes <= buffer->size_bytes);
    if (size_bytes > 0)
        glNamedBufferSubData(buffer->name, (GLintptr)offset_bytes, (GLsizeiptr)size_bytes, data);
}

void gpu_buffer_fill(struct gpu_buffer *buffer, size_t offset_bytes, size_t size_bytes,
                     uint32_t value)
{
    glClearNamedBufferSubData(buffer->name, GL_R32UI, (GLintptr)offset_bytes,
                              (GLsizeiptr)size_bytes, GL_RED_INTEGER, GL_UNSIGNED_INT, &value);
}

void gpu_buffer_clear(struct gpu_buffer *buffer)
{
    glClearNamedBufferData(buffer->name, GL_R8UI, GL_RED_INTEGER, GL_UNSIGNED_BYTE, NULL);
}

void gpu_buffer_copy(struct gpu_buffer *target, size_t target_offset_bytes,
                     const struct gpu_buffer *source, size_t source_offset_bytes, size_t size_bytes)
{
    glCopyNamedBufferSubData(source->name, target->name, (GLintptr)source_offset_bytes,
                             (GLintptr)target_offset_bytes, (GLsizeiptr)size_bytes);
}

void gpu_buffer_read(const struct gpu_buffer *buffer, size_t offset_bytes, size_t size_bytes,
                     void *out_data)
{
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    glGetNamedBufferSubData(buffer->name, (GLintptr)offset_bytes, (GLsizeiptr)size_bytes, out_data);
}

const void *gpu_buffer_mapping(const struct gpu_buffer *buffer)
{
    return buffer->mapping;
}

bool gpu_buffer_ensure(struct gpu *gpu, struct gpu_buffer **buffer, const char *label,
                       enum gpu_buffer_kind kind, size_t size_bytes)
{
    if (*buffer && (*buffer)->size_bytes >= size_bytes)
        return true;
    gpu_buffer_destroy(buffer);
    *buffer = gpu_buffer_create(gpu, label, kind, size_bytes, NULL);
    return *buffer != NULL;
}

uint32_t gpu_buffer_texture_name(struct gpu_buffer *buffer, enum gpu_texel texel)
{
    static const GLenum formats[GPU_TEXEL_COUNT] = {[GPU_TEXEL_UINT] = GL_R32UI,
                                                    [GPU_TEXEL_UINT3] = GL_RGB32UI,
                                                    [GPU_TEXEL_UINT4] = GL_RGBA32UI,
                                                    [GPU_TEXEL_FLOAT4] = GL_RGBA32F};
    GLuint *texture = &buffer->textures[texel];
    if (*texture == 0) {
        glCreateTextures(GL_TEXTURE_BUFFER, 1, texture);
        glTextureBuffer(*texture, formats[texel], buffer->name);
    }
    return *texture;
}

uint32_t gpu_buffer_name(const struct gpu_buffer *buffer)
{
    return buffer->name;
}
