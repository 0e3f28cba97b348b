#include "renderer/gpu/texture.h"

#include <assert.h>
#include <stdlib.h>

#include "renderer/gpu/internal.h"

struct gpu_texture {
    struct gpu_allocation allocation;
    GLuint name;
    struct gpu_texture_params params;
};

struct gpu_framebuffer {
    GLuint name;
    bool has_color;
};

static const struct {
    GLenum internal, format, type;
    uint32_t bytes;
} formats[] = {
    [GPU_FORMAT_R32UI] = {GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, 4},
    [GPU_FORMAT_RGBA32UI] = {GL_RGBA32UI, GL_RGBA_INTEGER, GL_UNSIGNED_INT, 16},
    [GPU_FORMAT_DEPTH32F] = {GL_DEPTH_COMPONENT32F, GL_DEPTH_COMPONENT, GL_FLOAT, 4},
    [GPU_FORMAT_RGBA8] = {GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE, 4},
    [GPU_FORMAT_SRGB8_ALPHA8] = {GL_SRGB8_ALPHA8, GL_RGBA, GL_UNSIGNED_BYTE, 4},
    [GPU_FORMAT_RGBA16F] = {GL_RGBA16F, GL_RGBA, GL_FLOAT, 8},
};

static void set_sampling(GLuint name, const struct gpu_texture_params *params)
{
    bool linear = params->filter != GPU_FILTER_NEAREST;
    GLint minify = linear ? GL_LINEAR : GL_NEAREST;
    if (linear && params->levels > 1)
        minify = params->filter == GPU_FILTER_LINEAR_NEAREST_LEVEL ? GL_LINEAR_MIPMAP_NEAREST
                                                                   : GL_LINEAR_MIPMAP_LINEAR;
    glTextureParameteri(name, GL_TEXTURE_MIN_FILTER, minify);
    glTextureParameteri(name, GL_TEXTURE_MAG_FILTER, linear ? GL_LINEAR : GL_NEAREST);
    glTextureParameteri(name, GL_TEXTURE_WRAP_S, params->repeat_u ? GL_REPEAT : GL_CLAMP_TO_EDGE);
    glTextureParameteri(name, GL_TEXTURE_WRAP_T, params->repeat_v ? GL_REPEAT : GL_CLAMP_TO_EDGE);
    if (params->filter == GPU_FILTER_SHADOW_COMPARE) {
        glTextureParameteri(name, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
        glTextureParameteri(name, GL_TEXTURE_COMPARE_FUNC, GL_GEQUAL);
    }
}

struct gpu_texture *gpu_texture_create(struct gpu *gpu, const struct gpu_texture_params *params)
{
    struct gpu_texture *texture = calloc(1, sizeof(*texture));
    if (!texture)
        return NULL;
    texture->params = *params;
    if (texture->params.levels == 0)
        texture->params.levels = 1;
    uint32_t layers = params->layers ? params->layers : 1;
    uint64_t bytes = 0;
    for (uint32_t level = 0; level < texture->params.levels; level++) {
        uint64_t width = params->width >> level, height = params->height >> level;
        layers = params->depth ? params->depth : layers;
        bytes +=
            (width ? width : 1) * (height ? height : 1) * layers * formats[params->format].bytes;
    }
    gpu_account(gpu, &texture->allocation, params->label, bytes);

    GLenum target = params->depth    ? GL_TEXTURE_3D
                    : params->layers ? GL_TEXTURE_2D_ARRAY
                                     : GL_TEXTURE_2D;
    glCreateTextures(target, 1, &texture->name);
    GLenum internal = formats[params->format].internal;
    GLsizei levels = (GLsizei)texture->params.levels;
    if (params->depth || params->layers)
        glTextureStorage3D(texture->name, levels, internal, (GLsizei)params->width,
                           (GLsizei)params->height,
                           (GLsizei)(params->depth ? params->depth : params->layers));
    else
        glTextureStorage2D(texture->name, levels, internal, (GLsizei)params->width,
                           (GLsizei)params->height);
    if (gpu_take_out_of_memory(gpu)) {
        gpu_texture_destroy(&texture);
        return NULL;
    }
    glObjectLabel(GL_TEXTURE, texture->name, -1, params->label);
    set_sampling(texture->name, &texture->params);
    return texture;
}

void gpu_texture_destroy(struct gpu_texture **texture_slot)
{
    struct gpu_texture *texture = *texture_slot;
    *texture_slot = NULL;
    if (!texture)
        return;
    glDeleteTextures(1, &texture->name);
    gpu_unaccount(&texture->allocation);
    free(texture);
}

void gpu_texture_write(struct gpu_texture *texture, uint32_t level, uint32_t layer,
                       const void *pixels)
{
    const struct gpu_texture_params *params = &texture->params;
    assert(level < params->levels);
    GLsizei width = (GLsizei)(params->width >> level), height = (GLsizei)(params->height >> level);
    width = width ? width : 1;
    height = height ? height : 1;
    GLenum format = formats[params->format].format, type = formats[params->format].type;
    if (params->layers)
        glTextureSubImage3D(texture->name, (GLint)level, 0, 0, (GLint)layer, width, height, 1,
                            format, type, pixels);
    else
        glTextureSubImage2D(texture->name, (GLint)level, 0, 0, width, height, format, type, pixels);
}

void gpu_texture_clear(struct gpu_texture *texture)
{
    GLenum format = formats[texture->params.format].format;
    GLenum type = formats[texture->params.format].type;
    for (uint32_t level = 0; level < texture->params.levels; level++)
        glClearTexImage(texture->name, (GLint)level, format, type, NULL);
}

void gpu_texture_read(const struct gpu_texture *texture, float *out_texels, size_t size_bytes)
{
    glMemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT);
    glGetTextureImage(texture->name, 0, GL_RGBA, GL_FLOAT, (GLsizei)size_bytes, out_texels);
}

void gpu_texture_read_layer(const struct gpu_texture *texture, uint32_t level, uint32_t layer,
                            void *out_pixels)
{
    const struct gpu_texture_params *params = &texture->params;
    GLsizei width = (GLsizei)(params->width >> level), height = (GLsizei)(params->height >> level);
    width = width ? width : 1;
    height = height ? height : 1;
    uint32_t bytes = formats[params->format].bytes;
    glMemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT);
    glGetTextureSubImage(texture->name, (GLint)level, 0, 0, (GLint)layer, width, height, 1,
                         formats[params->format].format, formats[params->format].type,
                         width * height * (GLsizei)bytes, out_pixels);
}

void gpu_bind_image(struct gpu *gpu, uint32_t slot, const struct gpu_texture *texture)
{
    (void)gpu;
    glBindImageTexture(slot, texture->name, 0, GL_TRUE, 0, GL_READ_WRITE,
                       formats[texture->params.format].internal);
}

void gpu_texture_generate_levels(struct gpu_texture *texture)
{
    glGenerateTextureMipmap(texture->name);
}

uint32_t gpu_texture_name(const struct gpu_texture *texture)
{
    return texture->name;
}

uint64_t gpu_texture_size_bytes(const struct gpu_texture *texture)
{
    return texture->allocation.bytes;
}

uint32_t gpu_texture_levels(const struct gpu_texture *texture)
{
    return texture->params.levels;
}

size_t gpu_texture_texel_count(const struct gpu_texture *texture, uint32_t level)
{
    const struct gpu_texture_params *params = &texture->params;
    size_t width = params->width >> level, height = params->height >> level;
    size_t depth = params->depth ? params->depth >> level : params->layers;
    return (width ? width : 1) * (height ? height : 1) * (depth ? depth : 1);
}

struct gpu_framebuffer *gpu_framebuffer_create(struct gpu *gpu, const char *label,
                                               const struct gpu_texture *color,
                                               const struct gpu_texture *depth,
                                               uint32_t depth_layer)
{
    (void)gpu;
    struct gpu_framebuffer *framebuffer = calloc(1, sizeof(*framebuffer));
    if (!framebuffer)
        return NULL;
    glCreateFramebuffers(1, &framebuffer->name);
    framebuffer->has_color = color != NULL;
    if (color)
        glNamedFramebufferTexture(framebuffer->name, GL_COLOR_ATTACHMENT0, color->name, 0);
    else
        glNamedFramebufferDrawBuffer(framebuffer->name, GL_NONE);
    if (depth->params.layers)
        glNamedFramebufferTextureLayer(framebuffer->name, GL_DEPTH_ATTACHMENT, depth->name, 0,
                                       (GLint)depth_layer);
    else
        glNamedFramebufferTexture(framebuffer->name, GL_DEPTH_ATTACHMENT, depth->name, 0);
    glObjectLabel(GL_FRAMEBUFFER, framebuffer->name, -1, label);
    if (glCheckNamedFramebufferStatus(framebuffer->name, GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
        gpu_framebuffer_destroy(&framebuffer);
    return framebuffer;
}

void gpu_framebuffer_destroy(struct gpu_framebuffer **framebuffer)
{
    if (*framebuffer)
        glDeleteFramebuffers(1, &(*framebuffer)->name);
    free(*framebuffer);
    *framebuffer = NULL;
}

void gpu_begin_raster(struct gpu *gpu, const struct gpu_raster_params *params)
{
    (void)gpu;
    glBindFramebuffer(GL_FRAMEBUFFER, params->framebuffer->name);
    glViewport(0, 0, (GLsizei)params->width, (GLsizei)params->height);
    glDepthFunc(GL_GREATER);
    glDepthMask(GL_TRUE);
    if (params->clear) {
        static const GLuint zero[4] = {0, 0, 0, 0};
        static const GLfloat far_plane = 0.0f;
        if (params->framebuffer->has_color)
            glClearNamedFramebufferuiv(params->framebuffer->name, GL_COLOR, 0, zero);
        glClearNamedFramebufferfv(params->framebuffer->name, GL_DEPTH, 0, &far_plane);
    }
    glDepthMask(params->depth_test == GPU_DEPTH_GREATER_WRITE);
    bool biased = params->depth_bias_slope != 0.0f || params->depth_bias_constant != 0.0f;
    if (biased) {
        glEnable(GL_POLYGON_OFFSET_FILL);
        glPolygonOffset(params->depth_bias_slope, params->depth_bias_constant);
    } else {
        glDisable(GL_POLYGON_OFFSET_FILL);
    }
}

void gpu_end_raster(struct gpu *gpu)
{
    (void)gpu;
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
}

uint32_t gpu_texture_edge(const struct gpu_texture *texture)
{
    return texture->params.width;
}
