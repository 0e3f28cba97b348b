#include "tests/support/exr_file.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define HEADER_BYTES 1024u // more than any header takes

struct writer {
    uint8_t *bytes;
    size_t size;
};

static void put(struct writer *writer, const void *bytes, size_t size)
{
    memcpy(writer->bytes + writer->size, bytes, size);
    writer->size += size;
}

static void put_word(struct writer *writer, uint32_t word)
{
    put(writer, &word, sizeof(word));
}

static void put_byte(struct writer *writer, uint8_t byte)
{
    put(writer, &byte, sizeof(byte));
}

static void put_text(struct writer *writer, const char *text)
{
    put(writer, text, strlen(text) + 1);
}

static void put_attribute(struct writer *writer, const char *name, const char *type, uint32_t size)
{
    put_text(writer, name);
    put_text(writer, type);
    put_word(writer, size);
}

static void put_float(struct writer *writer, const char *name, float value)
{
    put_attribute(writer, name, "float", sizeof(value));
    put(writer, &value, sizeof(value));
}

static void put_window(struct writer *writer, const char *name, uint32_t width, uint32_t height)
{
    put_attribute(writer, name, "box2i", 16);
    put_word(writer, 0);
    put_word(writer, 0);
    put_word(writer, width - 1);
    put_word(writer, height - 1);
}

static void put_channels(struct writer *writer, const struct exr_file_params *params)
{
    uint32_t type = params->pixel_type ? params->pixel_type - 1 : params->half ? 1 : 2;
    uint32_t sampling = params->sampling ? params->sampling : 1;
    put_attribute(writer, "channels", "chlist", (uint32_t)strlen(params->channels) * 18 + 1);
    for (const char *name = params->channels; *name; name++) {
        put_byte(writer, (uint8_t)*name);
        put_byte(writer, 0);
        put_word(writer, type);
        put_word(writer, 0);
        put_word(writer, sampling);
        put_word(writer, sampling);
    }
    put_byte(writer, 0);
}

static void put_header(struct writer *writer, const struct exr_file_params *params)
{
    uint32_t width = params->told_width ? params->told_width : params->width;
    uint32_t height = params->told_height ? params->told_height : params->height;
    put_word(writer, 20000630);
    put_word(writer, 2 | (params->tile_edge ? 0x200 : 0));
    put_channels(writer, params);
    put_attribute(writer, "compression", "compression", 1);
    put_byte(writer, 0);
    put_window(writer, "dataWindow", width, height);
    put_window(writer, "displayWindow", params->display_width ? params->display_width : width,
               height);
    if (params->cube) {
        put_attribute(writer, "envmap", "envmap", 1);
        put_byte(writer, 1);
    }
    put_attribute(writer, "lineOrder", "lineOrder", 1);
    put_byte(writer, 0);
    put_float(writer, "pixelAspectRatio", 1.0f);
    put_attribute(writer, "screenWindowCenter", "v2f", 8);
    put_word(writer, 0);
    put_word(writer, 0);
    put_float(writer, "screenWindowWidth", 1.0f);
    if (params->tile_edge) {
        put_attribute(writer, "tiles", "tiledesc", 9);
        put_word(writer, params->tile_edge);
        put_word(writer, params->tile_edge);
        put_byte(writer, 0);
    }
    put_byte(writer, 0);
}

// By arithmetic rather than by the bits that the decoder handles.
static uint16_t half_of(float value)
{
    uint16_t sign = signbit(value) ? 0x8000 : 0;
    float size = fabsf(value);
    if (isnan(value))
        return 0x7e00;
    if (size > 65504.0f)
        return sign | 0x7c00;
    if (size < 0x1p-14f)
        return sign | (uint16_t)lrintf(size * 0x1p24f);
    int exponent;
    float mantissa = frexpf(size, &exponent); // 0.5 .. 1
    return sign | (uint16_t)(((exponent + 14) << 10) + lrintf((mantissa * 2.0f - 1.0f) * 1024.0f));
}

static void put_texels(struct writer *writer, const struct exr_file_params *params,
                       const float *texels, uint32_t x, uint32_t y, uint32_t width)
{
    for (const char *name = params->channels; *name; name++) {
        size_t component = *name == 'G'                   ? 1
                           : *name == 'B'                 ? 2
                           : *name == 'R' || *name == 'Y' ? 0
                                                          : 3;
        for (uint32_t i = x; i < x + width; i++) {
            float value = texels[4 * ((size_t)y * params->width + i) + component];
            uint16_t half = half_of(value);
            if (params->half)
                put(writer, &half, sizeof(half));
            else
                put(writer, &value, sizeof(value));
        }
    }
}

static uint32_t min_of(uint32_t value, uint32_t limit)
{
    return value < limit ? value : limit;
}

// A chunk is a line or a tile.
static void put_chunks(struct writer *writer, const struct exr_file_params *params,
                       const float *texels)
{
    uint32_t edge = params->tile_edge;
    uint32_t across = edge ? (params->width + edge - 1) / edge : 1;
    uint32_t down = edge ? (params->height + edge - 1) / edge : params->height;
    size_t texel_bytes = strlen(params->channels) * (params->half ? 2 : 4);
    size_t table = writer->size;
    writer->size += (size_t)across * down * sizeof(uint64_t);
    for (uint32_t i = 0; i < across * down; i++) {
        uint32_t tile_x = i % across, tile_y = i / across;
        uint32_t x = tile_x * edge, y = edge ? tile_y * edge : tile_y;
        uint32_t width = edge ? min_of(edge, params->width - x) : params->width;
        uint32_t height = edge ? min_of(edge, params->height - y) : 1;
        uint64_t offset = writer->size;
        memcpy(writer->bytes + table + i * sizeof(offset), &offset, sizeof(offset));
        if (edge)
            put_word(writer, tile_x);
        put_word(writer, tile_y);
        for (int level = 0; level < 2 && edge; level++)
            put_word(writer, 0);
        put_word(writer, (uint32_t)(texel_bytes * width * height));
        for (uint32_t row = 0; row < height; row++)
            put_texels(writer, params, texels, x, y + row, width);
    }
}

uint8_t *exr_file_write(const struct exr_file_params *params, const float *texels, size_t *out_size)
{
    size_t texel_count = (size_t)params->width * params->height;
    // Each texel may be a tile with a head and an offset of its own.
    struct writer writer = {
        .bytes = calloc(1, HEADER_BYTES + texel_count * (4 * strlen(params->channels) + 32))};
    if (!writer.bytes)
        return NULL;
    put_header(&writer, params);
    put_chunks(&writer, params, texels);
    *out_size = writer.size;
    return writer.bytes;
}
