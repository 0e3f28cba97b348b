#include "renderer/gpu/gpu.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "renderer/clock.h"
#include "renderer/gpu/buffer.h"
#include "renderer/gpu/internal.h"
#include "renderer/gpu/program.h"
#include "renderer/gpu/texture.h"
#include "renderer/gpu/timer.h"
#include "renderer/log.h"
#include "shared/slots.h"

#define GL_FENCE_WAIT_NS 2000000000ull

static void APIENTRY on_gl_message(GLenum source, GLenum type, GLuint id, GLenum severity,
                                   GLsizei length, const GLchar *message, const void *user)
{
    (void)source;
    (void)length;
    struct gpu *gpu = (struct gpu *)user;
    if (type == GL_DEBUG_TYPE_ERROR) {
        gpu->error_count++;
        log_write(LOG_ERROR, "gl_error id=%u message=\"%s\"", id, message);
    } else if (severity == GL_DEBUG_SEVERITY_HIGH) {
        log_write(LOG_WARN, "gl_warning id=%u message=\"%s\"", id, message);
    }
}

static void read_info(struct gpu *gpu)
{
    struct renderer_info *info = &gpu->info;
    snprintf(info->gl_renderer, sizeof(info->gl_renderer), "%s",
             (const char *)glGetString(GL_RENDERER));
    snprintf(info->gl_version, sizeof(info->gl_version), "%s",
             (const char *)glGetString(GL_VERSION));
    info->software = strstr(info->gl_renderer, "llvmpipe") ||
                     strstr(info->gl_renderer, "softpipe") || strstr(info->gl_renderer, "swr");
    GLint edge = 0;
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, &edge);
    info->max_texture_edge = (uint32_t)edge;
    GLint texels = 0;
    glGetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &texels);
    info->max_buffer_texels = (uint32_t)texels;
}

// Checks GL limits that the shaders rely on (shaders/shared/slots.h). Mesa and NVIDIA offer as many
// texture units and twice as many texels; the others are at or near GL 4.5's minimum.
static bool check_limits(struct error *out_error)
{
    static const struct {
        GLenum name;
        GLint needed;
        const char *text;
    } limits[] = {
        {GL_MAX_COMPUTE_SHADER_STORAGE_BLOCKS, 16, "GL_MAX_COMPUTE_SHADER_STORAGE_BLOCKS"},
        {GL_MAX_SHADER_STORAGE_BUFFER_BINDINGS, STORAGE_BINDINGS,
         "GL_MAX_SHADER_STORAGE_BUFFER_BINDINGS"},
        {GL_MAX_COMPUTE_TEXTURE_IMAGE_UNITS, 32, "GL_MAX_COMPUTE_TEXTURE_IMAGE_UNITS"},
        {GL_MAX_COMBINED_TEXTURE_IMAGE_UNITS, TEXTURE_UNITS, "GL_MAX_COMBINED_TEXTURE_IMAGE_UNITS"},
        {GL_MAX_TEXTURE_BUFFER_SIZE, 1 << 26, "GL_MAX_TEXTURE_BUFFER_SIZE"},
        {GL_MAX_FRAGMENT_SHADER_STORAGE_BLOCKS, 8, "GL_MAX_FRAGMENT_SHADER_STORAGE_BLOCKS"},
        {GL_MAX_VERTEX_SHADER_STORAGE_BLOCKS, 2, "GL_MAX_VERTEX_SHADER_STORAGE_BLOCKS"},
        {GL_MAX_COMPUTE_WORK_GROUP_INVOCATIONS, 256, "GL_MAX_COMPUTE_WORK_GROUP_INVOCATIONS"},
    };
    for (size_t i = 0; i < sizeof(limits) / sizeof(limits[0]); i++) {
        GLint value = 0;
        glGetIntegerv(limits[i].name, &value);
        if (value < limits[i].needed)
            return error_set(out_error, "this GL driver offers %s = %d; at least %d is needed",
                             limits[i].text, value, limits[i].needed);
    }
    return true;
}

struct gpu *gpu_create(const char *choice, const char *shader_dir, struct error *out_error)
{
    struct gpu *gpu = calloc(1, sizeof(*gpu));
    if (!gpu) {
        error_set(out_error, "out of memory");
        return NULL;
    }
    snprintf(gpu->shader_dir, sizeof(gpu->shader_dir), "%s", shader_dir);
    if (!gpu_egl_open(gpu, choice, out_error))
        goto fail;
    int version = epoxy_gl_version();
    if (version < 45) {
        error_set(out_error, "the GL driver offers OpenGL %d.%d; 4.5 core is needed", version / 10,
                  version % 10);
        goto fail;
    }
    glDebugMessageCallback(on_gl_message, gpu);
    glEnable(GL_DEBUG_OUTPUT);
    glEnable(GL_DEBUG_OUTPUT_SYNCHRONOUS);
    read_info(gpu);
    if (!check_limits(out_error))
        goto fail;
    // Reversed Z in [0, 1]: floating-point depth stays precise at a distance.
    glClipControl(GL_UPPER_LEFT, GL_ZERO_TO_ONE);
    glEnable(GL_DEPTH_TEST);
    glProvokingVertex(GL_FIRST_VERTEX_CONVENTION);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
    // llvmpipe itself, that is, and not what draws by it, such as zink.
    gpu->pinned_memory = strncmp(gpu->info.gl_renderer, "llvmpipe", 8) == 0 &&
                         epoxy_has_gl_extension("GL_AMD_pinned_memory");
    gpu->info.gpu_timers = !gpu->info.software && gpu_timer_probe(gpu);
    return gpu;
fail:
    gpu_destroy(&gpu);
    return NULL;
}

void gpu_destroy(struct gpu **gpu_slot)
{
    struct gpu *gpu = *gpu_slot;
    *gpu_slot = NULL;
    if (!gpu)
        return;
    gpu_programs_destroy(gpu);
    assert(!gpu->allocations);
    gpu_egl_close(gpu);
    free(gpu->shader_defines);
    free(gpu);
}

const struct renderer_info *gpu_get_info(const struct gpu *gpu)
{
    return &gpu->info;
}

const char *gpu_get_shader_dir(const struct gpu *gpu)
{
    return gpu->shader_dir;
}

void gpu_count_error(struct gpu *gpu)
{
    gpu->error_count++;
}

uint64_t gpu_error_count(const struct gpu *gpu)
{
    return gpu->error_count;
}

void gpu_account(struct gpu *gpu, struct gpu_allocation *allocation, const char *label,
                 uint64_t bytes)
{
    snprintf(allocation->label, sizeof(allocation->label), "%s", label);
    allocation->bytes = bytes;
    allocation->next = gpu->allocations;
    allocation->link = &gpu->allocations;
    if (allocation->next)
        allocation->next->link = &allocation->next;
    gpu->allocations = allocation;
}

void gpu_unaccount(struct gpu_allocation *allocation)
{
    *allocation->link = allocation->next;
    if (allocation->next)
        allocation->next->link = allocation->link;
}

uint32_t gpu_memory_groups(const struct gpu *gpu, struct gpu_memory_group *out_groups,
                           uint32_t capacity)
{
    uint32_t count = 0;
    for (const struct gpu_allocation *it = gpu->allocations; it; it = it->next) {
        struct gpu_memory_group group = {.bytes = it->bytes};
        snprintf(group.name, sizeof(group.name), "%.*s", (int)strcspn(it->label, "."), it->label);
        uint32_t at = 0;
        while (at < count && strcmp(out_groups[at].name, group.name) < 0)
            at++;
        if (at < count && strcmp(out_groups[at].name, group.name) == 0) {
            out_groups[at].bytes += group.bytes;
        } else if (count < capacity) {
            memmove(&out_groups[at + 1], &out_groups[at], (count - at) * sizeof(group));
            out_groups[at] = group;
            count++;
        }
    }
    return count;
}

void gpu_inject_fault(struct gpu *gpu, enum renderer_fault fault, uint64_t number)
{
    gpu->faults[fault] = number;
}

uint64_t gpu_fault_left(const struct gpu *gpu, enum renderer_fault fault)
{
    return gpu->faults[fault];
}

bool gpu_fault_strikes(struct gpu *gpu, enum renderer_fault fault)
{
    return gpu->faults[fault] > 0 && --gpu->faults[fault] == 0;
}

bool gpu_is_lost(struct gpu *gpu)
{
    gpu->lost = gpu->lost || glGetGraphicsResetStatus() != GL_NO_ERROR ||
                gpu_fault_strikes(gpu, RENDERER_FAULT_CONTEXT);
    return gpu->lost;
}

bool gpu_take_out_of_memory(struct gpu *gpu)
{
    bool out_of_memory = gpu_fault_strikes(gpu, RENDERER_FAULT_ALLOCATION);
    for (GLenum error; (error = glGetError()) != GL_NO_ERROR;)
        out_of_memory = out_of_memory || error == GL_OUT_OF_MEMORY;
    return out_of_memory;
}

void gpu_push_group(struct gpu *gpu, const char *name)
{
    (void)gpu;
    glPushDebugGroup(GL_DEBUG_SOURCE_APPLICATION, 0, -1, name);
}

void gpu_pop_group(struct gpu *gpu)
{
    (void)gpu;
    glPopDebugGroup();
}

void gpu_bind_storage(struct gpu *gpu, uint32_t slot, const struct gpu_buffer *buffer)
{
    (void)gpu;
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, slot, buffer ? gpu_buffer_name(buffer) : 0);
}

bool gpu_texels_fit(const struct gpu *gpu, enum gpu_texel texel, uint64_t size_bytes)
{
    static const uint64_t texel_bytes[GPU_TEXEL_COUNT] = {[GPU_TEXEL_UINT] = 4,
                                                          [GPU_TEXEL_UINT3] = 12,
                                                          [GPU_TEXEL_UINT4] = 16,
                                                          [GPU_TEXEL_FLOAT4] = 16};
    return size_bytes / texel_bytes[texel] <= gpu->info.max_buffer_texels;
}

void gpu_bind_texels(struct gpu *gpu, uint32_t unit, const struct gpu_buffer *buffer,
                     enum gpu_texel texel)
{
    (void)gpu;
    struct gpu_buffer *own = (struct gpu_buffer *)buffer; // all of them are this folder's
    glBindTextureUnit(unit, own ? gpu_buffer_texture_name(own, texel) : 0);
}

void gpu_bind_uniforms(struct gpu *gpu, uint32_t slot, const struct gpu_buffer *buffer)
{
    (void)gpu;
    glBindBufferBase(GL_UNIFORM_BUFFER, slot, gpu_buffer_name(buffer));
}

void gpu_bind_texture(struct gpu *gpu, uint32_t slot, const struct gpu_texture *texture)
{
    (void)gpu;
    glBindTextureUnit(slot, texture ? gpu_texture_name(texture) : 0);
}

static void use_program(struct gpu *gpu, const struct gpu_program *program)
{
    uint32_t name = gpu_program_name(program);
    if (gpu->current_program != name)
        glUseProgram(name);
    gpu->current_program = name;
}

void gpu_set_yield(struct gpu *gpu, void (*yield)(void *user), void *user)
{
    gpu->yield = gpu->info.software ? yield : NULL;
    gpu->yield_user = user;
}

double gpu_clock_ms(const struct gpu *gpu)
{
    return clock_now_ms() - gpu->waited_ms;
}

static void yield(struct gpu *gpu)
{
    if (!gpu->yield)
        return;
    double from_ms = clock_now_ms();
    gpu->yield(gpu->yield_user);
    gpu->waited_ms += clock_now_ms() - from_ms;
}

void gpu_dispatch(struct gpu *gpu, const struct gpu_program *program, uint32_t x, uint32_t y,
                  uint32_t z)
{
    if (x == 0 || y == 0 || z == 0)
        return;
    yield(gpu);
    use_program(gpu, program);
    glDispatchCompute(x, y, z);
}

void gpu_dispatch_indirect(struct gpu *gpu, const struct gpu_program *program,
                           const struct gpu_buffer *arguments, size_t offset_bytes)
{
    yield(gpu);
    use_program(gpu, program);
    glBindBuffer(GL_DISPATCH_INDIRECT_BUFFER, gpu_buffer_name(arguments));
    glDispatchComputeIndirect((GLintptr)offset_bytes);
}

void gpu_barrier(struct gpu *gpu)
{
    (void)gpu;
    glMemoryBarrier(GL_ALL_BARRIER_BITS);
}

void gpu_draw_indirect(struct gpu *gpu, const struct gpu_draw_params *params)
{
    if (params->count == 0)
        return;
    yield(gpu);
    use_program(gpu, params->program);
    GLuint vertex_array = *(const GLuint *)params->geometry;
    glVertexArrayVertexBuffer(vertex_array, 1, gpu_buffer_name(params->records), 0,
                              sizeof(struct gpu_draw_record));
    glBindVertexArray(vertex_array);
    glBindBuffer(GL_DRAW_INDIRECT_BUFFER, gpu_buffer_name(params->draws));
    if (params->cull == GPU_CULL_NONE) {
        glDisable(GL_CULL_FACE);
    } else {
        glEnable(GL_CULL_FACE);
        glCullFace(params->cull == GPU_CULL_BACK ? GL_BACK : GL_FRONT);
    }
    size_t offset_bytes = params->first * sizeof(struct gpu_draw);
    glMultiDrawElementsIndirect(GL_TRIANGLES, GL_UNSIGNED_INT, (const void *)offset_bytes,
                                (GLsizei)params->count, 0);
}

struct gpu_geometry {
    GLuint name;
};

struct gpu_geometry *gpu_geometry_create(struct gpu *gpu, const struct gpu_buffer *vertices,
                                         const struct gpu_buffer *indices)
{
    (void)gpu;
    struct gpu_geometry *geometry = calloc(1, sizeof(*geometry));
    if (!geometry)
        return NULL;
    glCreateVertexArrays(1, &geometry->name);
    GLuint name = geometry->name;
    glObjectLabel(GL_VERTEX_ARRAY, name, -1, "geometry");
    glVertexArrayVertexBuffer(name, 0, gpu_buffer_name(vertices), 0, sizeof(struct raster_vertex));
    glVertexArrayBindingDivisor(name, 1, 1);
    glVertexArrayElementBuffer(name, gpu_buffer_name(indices));
    glVertexArrayAttribFormat(name, 0, 3, GL_FLOAT, GL_FALSE,
                              offsetof(struct raster_vertex, position));
    glVertexArrayAttribFormat(name, 1, 4, GL_FLOAT, GL_FALSE, offsetof(struct raster_vertex, uv));
    for (GLuint row = 0; row < 4; row++)
        glVertexArrayAttribFormat(name, 2 + row, 4, GL_FLOAT, GL_FALSE,
                                  row * (GLuint)sizeof(float[4]));
    glVertexArrayAttribFormat(name, 6, 1, GL_FLOAT, GL_FALSE,
                              offsetof(struct raster_vertex, alpha));
    glVertexArrayAttribIFormat(name, 7, 1, GL_UNSIGNED_INT,
                               offsetof(struct raster_vertex, triangle));
    glVertexArrayAttribIFormat(name, 8, 2, GL_UNSIGNED_INT,
                               offsetof(struct gpu_draw_record, first_id));
    for (GLuint attribute = 0; attribute < 9; attribute++) {
        bool per_draw = (attribute >= 2 && attribute <= 5) || attribute == 8;
        glVertexArrayAttribBinding(name, attribute, per_draw ? 1 : 0);
        glEnableVertexArrayAttrib(name, attribute);
    }
    return geometry;
}

void gpu_geometry_destroy(struct gpu_geometry **geometry)
{
    if (*geometry)
        glDeleteVertexArrays(1, &(*geometry)->name);
    free(*geometry);
    *geometry = NULL;
}

struct gpu_fence *gpu_fence_create(struct gpu *gpu)
{
    (void)gpu;
    GLsync sync = glFenceSync(GL_SYNC_GPU_COMMANDS_COMPLETE, 0);
    glFlush();
    return (struct gpu_fence *)sync;
}

bool gpu_fence_is_done(struct gpu_fence *fence, bool wait)
{
    GLenum result;
    do {
        result = glClientWaitSync((GLsync)fence, 0, wait ? GL_FENCE_WAIT_NS : 0);
    } while (wait && result == GL_TIMEOUT_EXPIRED);
    return result == GL_ALREADY_SIGNALED || result == GL_CONDITION_SATISFIED;
}

void gpu_fence_destroy(struct gpu_fence **fence)
{
    if (*fence)
        glDeleteSync((GLsync)*fence);
    *fence = NULL;
}
