// The library finds and decompresses chunks; what it is to find is checked before, and its bytes
// are turned into floats here, within bounds that this file knows.
#include "renderer/image/exr_decode.h"

#include <openexr.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "renderer/image/environment_image.h"
#include "renderer/image/image.h"

// A chunk is at most 256 lines of the widest image, or a tile, of all channels.
#define MAX_CHUNK_BYTES (ENVIRONMENT_MAX_BYTES)
#define MAX_TILE_EDGE   4096

struct exr_file {
    const uint8_t *bytes;
    size_t size;
    char message[200]; // of the library, the first
};

// Where a channel of the file goes: components first .. first + count - 1 of a texel.
struct channel {
    bool half;
    uint32_t first, count; // count 0: it is not used
};

struct exr_image {
    exr_context_t context;
    int32_t left, top; // of the data window
    uint32_t width, height;
    bool tiled;
    uint32_t channel_count;
    struct channel channels[EXR_MAX_CHANNELS];
    size_t bytes_per_texel; // of all channels
    float *pixels;
};

bool exr_is_exr(const uint8_t *bytes, size_t size)
{
    return size >= 4 && memcmp(bytes, "\x76\x2f\x31\x01", 4) == 0;
}

static int64_t read_bytes(exr_const_context_t context, void *user, void *buffer, uint64_t size,
                          uint64_t offset, exr_stream_error_func_ptr_t tell)
{
    const struct exr_file *file = user;
    (void)context;
    (void)tell;
    uint64_t there = offset < file->size ? file->size - offset : 0;
    uint64_t count = size < there ? size : there;
    if (count > 0)
        memcpy(buffer, file->bytes + offset, count);
    return (int64_t)count;
}

static int64_t tell_size(exr_const_context_t context, void *user)
{
    (void)context;
    return (int64_t)((const struct exr_file *)user)->size;
}

static void *limited_alloc(size_t size)
{
    return size > MAX_CHUNK_BYTES ? NULL : malloc(size);
}

static void take_message(exr_const_context_t context, exr_result_t code, const char *message)
{
    void *user = NULL;
    if (!context || exr_get_user_data(context, &user) != EXR_ERR_SUCCESS || !user)
        return;
    struct exr_file *file = user;
    if (!file->message[0])
        snprintf(file->message, sizeof(file->message), "%s",
                 message && message[0] ? message : exr_get_default_error_message(code));
}

static bool fail(const struct exr_file *file, exr_result_t code, const char *what,
                 struct error *out_error)
{
    return error_set(out_error, "%s: %s", what,
                     file->message[0] ? file->message : exr_get_default_error_message(code));
}

static bool check_storage(struct exr_image *image, struct error *out_error)
{
    int part_count = 0;
    exr_storage_t storage = EXR_STORAGE_LAST_TYPE;
    exr_envmap_t map = EXR_ENVMAP_LATLONG;
    exr_get_count(image->context, &part_count);
    if (part_count != 1)
        return error_set(out_error,
                         "a multi-part OpenEXR file of %d parts; allowed is one part, of scanlines "
                         "or tiles",
                         part_count);
    exr_get_storage(image->context, 0, &storage);
    if (storage != EXR_STORAGE_SCANLINE && storage != EXR_STORAGE_TILED)
        return error_set(out_error,
                         "a deep OpenEXR image; allowed are scanlines or tiles of flat texels");
    if (exr_attr_get_envmap(image->context, 0, "envmap", &map) == EXR_ERR_SUCCESS &&
        map != EXR_ENVMAP_LATLONG)
        return error_set(out_error, "an OpenEXR cube map; allowed is an equirectangular "
                                    "(latitude-longitude) image");
    // The library's C interface has no DWA before version 3.2.
    exr_compression_t compression = EXR_COMPRESSION_LAST_TYPE;
    exr_get_compression(image->context, 0, &compression);
    if (compression > EXR_COMPRESSION_B44A)
        return error_set(out_error, "an OpenEXR image compressed by DWAA, DWAB or something newer; "
                                    "allowed are none, RLE, ZIPS, ZIP, PIZ, PXR24, B44 and B44A");
    image->tiled = storage == EXR_STORAGE_TILED;
    return true;
}

static bool check_windows(struct exr_image *image, struct error *out_error)
{
    exr_attr_box2i_t data, display;
    if (exr_get_data_window(image->context, 0, &data) != EXR_ERR_SUCCESS ||
        exr_get_display_window(image->context, 0, &display) != EXR_ERR_SUCCESS)
        return error_set(out_error, "an OpenEXR file without data window or display window");
    int64_t width = (int64_t)data.max.x - data.min.x + 1;
    int64_t height = (int64_t)data.max.y - data.min.y + 1;
    if (width < 1 || height < 1 || width > IMAGE_MAX_EDGE || height > IMAGE_MAX_EDGE ||
        width * height * (int64_t)sizeof(float[3]) > ENVIRONMENT_MAX_BYTES)
        return error_set(out_error,
                         "an image of %lld x %lld texels; allowed are 1 to %u a side and %u MiB of "
                         "floats",
                         (long long)width, (long long)height, IMAGE_MAX_EDGE,
                         ENVIRONMENT_MAX_BYTES >> 20);
    if (memcmp(&data, &display, sizeof(data)) != 0)
        return error_set(
            out_error,
            "data window (%d, %d)-(%d, %d) and display window (%d, %d)-(%d, %d) differ; "
            "an environment needs all of its sphere",
            data.min.x, data.min.y, data.max.x, data.max.y, display.min.x, display.min.y,
            display.max.x, display.max.y);
    image->left = data.min.x;
    image->top = data.min.y;
    image->width = (uint32_t)width;
    image->height = (uint32_t)height;
    return true;
}

static bool check_tiles(const struct exr_image *image, struct error *out_error)
{
    uint32_t width = 0, height = 0;
    exr_tile_level_mode_t levels;
    exr_tile_round_mode_t round;
    if (!image->tiled)
        return true;
    if (exr_get_tile_descriptor(image->context, 0, &width, &height, &levels, &round) !=
            EXR_ERR_SUCCESS ||
        width < 1 || height < 1 || width > MAX_TILE_EDGE || height > MAX_TILE_EDGE)
        return error_set(out_error, "tiles of %u x %u texels; allowed are 1 to %d a side", width,
                         height, MAX_TILE_EDGE);
    return true;
}

static bool check_channel(const exr_attr_chlist_entry_t *entry, struct error *out_error)
{
    if (entry->x_sampling != 1 || entry->y_sampling != 1)
        return error_set(out_error,
                         "channel %.60s is sampled at every %d x %d texels; allowed is "
                         "every texel",
                         entry->name.str, entry->x_sampling, entry->y_sampling);
    return true;
}

// Where R, G, B or, if there are none of them, Y are to go; others are left out.
static bool choose_channels(struct exr_image *image, const exr_attr_chlist_t *list,
                            struct error *out_error)
{
    static const char *const names[] = {"R", "G", "B"};
    bool found[3] = {false};
    int luminance = -1;
    for (int i = 0; i < list->num_channels; i++) {
        const exr_attr_chlist_entry_t *entry = &list->entries[i];
        struct channel *channel = &image->channels[i];
        channel->half = entry->pixel_type == EXR_PIXEL_HALF;
        image->bytes_per_texel += channel->half ? 2 : 4;
        if (!check_channel(entry, out_error))
            return false;
        for (uint32_t c = 0; c < 3; c++) {
            if (strcmp(entry->name.str, names[c]) != 0)
                continue;
            *channel = (struct channel){channel->half, c, 1};
            found[c] = true;
        }
        if (strcmp(entry->name.str, "Y") == 0)
            luminance = i;
        if ((channel->count > 0 || luminance == i) && entry->pixel_type == EXR_PIXEL_UINT)
            return error_set(out_error, "channel %.60s holds integers; allowed are half and float",
                             entry->name.str);
    }
    if (found[0] && found[1] && found[2])
        return true;
    if (luminance < 0 || found[0] || found[1] || found[2])
        return error_set(out_error, "channels R, G and B, or Y, are needed; %s%s%s%s",
                         found[0] ? "R is there " : "", found[1] ? "G is there " : "",
                         found[2] ? "B is there " : "",
                         found[0] || found[1] || found[2] ? "alone" : "none of them is there");
    image->channels[luminance].count = 3;
    return true;
}

static bool check_channels(struct exr_image *image, struct error *out_error)
{
    const exr_attr_chlist_t *list = NULL;
    if (exr_get_channels(image->context, 0, &list) != EXR_ERR_SUCCESS || !list)
        return error_set(out_error, "an OpenEXR file without a list of channels");
    if (list->num_channels < 1 || list->num_channels > EXR_MAX_CHANNELS)
        return error_set(out_error, "%d channels; allowed are 1 to %d", list->num_channels,
                         EXR_MAX_CHANNELS);
    image->channel_count = (uint32_t)list->num_channels;
    return choose_channels(image, list, out_error);
}

static float float_of_half(uint16_t half)
{
    uint32_t sign = (uint32_t)(half & 0x8000) << 16;
    uint32_t exponent = half >> 10 & 31, mantissa = half & 1023;
    float value;
    if (exponent == 0) {
        value = (float)mantissa * 0x1p-24f;
        return sign ? -value : value;
    }
    uint32_t bits = sign | (exponent == 31 ? 255u : exponent + 112) << 23 | mantissa << 13;
    memcpy(&value, &bits, sizeof(value));
    return value;
}

// Lines of a chunk: all texels of one channel after the other, in little endian.
static void take_line(const struct exr_image *image, const uint8_t *at, float *texels,
                      uint32_t width)
{
    for (uint32_t i = 0; i < image->channel_count; i++) {
        const struct channel *channel = &image->channels[i];
        size_t size = channel->half ? 2 : 4;
        for (uint32_t x = 0; channel->count > 0 && x < width; x++) {
            float value;
            uint16_t half;
            if (channel->half) {
                memcpy(&half, at + 2 * (size_t)x, sizeof(half));
                value = float_of_half(half);
            } else {
                memcpy(&value, at + 4 * (size_t)x, sizeof(value));
            }
            for (uint32_t c = 0; c < channel->count; c++)
                texels[3 * (size_t)x + channel->first + c] = value;
        }
        at += size * width;
    }
}

// Places are of the image, not of the data window.
static bool take_chunk(struct exr_image *image, exr_decode_pipeline_t *pipeline, uint32_t x,
                       uint32_t y, struct error *out_error)
{
    const exr_chunk_info_t *chunk = &pipeline->chunk;
    const uint8_t *bytes = pipeline->unpacked_buffer;
    if (chunk->width < 1 || chunk->height < 1 || (uint32_t)chunk->width > image->width - x ||
        (uint32_t)chunk->height > image->height - y)
        return error_set(out_error, "a chunk of %d x %d texels at (%u, %u) leaves the image",
                         chunk->width, chunk->height, x, y);
    size_t line = image->bytes_per_texel * (size_t)chunk->width;
    if (!bytes || chunk->unpacked_size != line * (size_t)chunk->height)
        return error_set(out_error, "the chunk at (%u, %u) has another size than its texels", x, y);
    for (uint32_t row = 0; row < (uint32_t)chunk->height; row++)
        take_line(image, bytes + row * line,
                  image->pixels + 3 * ((size_t)(y + row) * image->width + x),
                  (uint32_t)chunk->width);
    return true;
}

// Chunk after chunk with one pipeline, whose buffers serve all.
static exr_result_t run_pipeline(const struct exr_image *image, exr_decode_pipeline_t *pipeline,
                                 const exr_chunk_info_t *chunk)
{
    exr_result_t result = pipeline->channels
                              ? exr_decoding_update(image->context, 0, chunk, pipeline)
                              : exr_decoding_initialize(image->context, 0, chunk, pipeline);
    // Routines read and decompress; what would unpack knows no bounds of ours.
    if (result == EXR_ERR_SUCCESS && !pipeline->read_fn)
        result = exr_decoding_choose_default_routines(image->context, 0, pipeline);
    pipeline->unpack_and_convert_fn = NULL;
    return result == EXR_ERR_SUCCESS ? exr_decoding_run(image->context, 0, pipeline) : result;
}

static bool read_chunk(struct exr_image *image, const struct exr_file *file,
                       exr_decode_pipeline_t *pipeline, uint32_t x, uint32_t y,
                       const exr_chunk_info_t *chunk, struct error *out_error)
{
    char what[80];
    snprintf(what, sizeof(what), "the chunk at (%u, %u) is damaged", x, y);
    if (chunk->unpacked_size > MAX_CHUNK_BYTES || chunk->packed_size > file->size)
        return error_set(out_error, "%s: it has %llu bytes; allowed are %u", what,
                         (unsigned long long)chunk->unpacked_size, MAX_CHUNK_BYTES);
    exr_result_t result = run_pipeline(image, pipeline, chunk);
    if (result != EXR_ERR_SUCCESS)
        return fail(file, result, what, out_error);
    return take_chunk(image, pipeline, x, y, out_error);
}

static bool read_scanlines(struct exr_image *image, const struct exr_file *file,
                           exr_decode_pipeline_t *pipeline, struct error *out_error)
{
    int32_t lines = 0;
    if (exr_get_scanlines_per_chunk(image->context, 0, &lines) != EXR_ERR_SUCCESS || lines < 1)
        return error_set(out_error, "an OpenEXR file without scanlines");
    for (uint32_t y = 0; y < image->height; y += (uint32_t)lines) {
        exr_chunk_info_t chunk = {0};
        exr_result_t result =
            exr_read_scanline_chunk_info(image->context, 0, image->top + (int32_t)y, &chunk);
        if (result != EXR_ERR_SUCCESS) {
            char what[80];
            snprintf(what, sizeof(what), "the file is truncated or damaged at line %u", y);
            return fail(file, result, what, out_error);
        }
        if (!read_chunk(image, file, pipeline, 0, y, &chunk, out_error))
            return false;
    }
    return true;
}

static bool read_tiles(struct exr_image *image, const struct exr_file *file,
                       exr_decode_pipeline_t *pipeline, struct error *out_error)
{
    uint32_t width = 0, height = 0;
    exr_tile_level_mode_t levels;
    exr_tile_round_mode_t round;
    exr_get_tile_descriptor(image->context, 0, &width, &height, &levels, &round);
    for (uint32_t y = 0; y < image->height; y += height)
        for (uint32_t x = 0; x < image->width; x += width) {
            exr_chunk_info_t chunk = {0};
            exr_result_t result = exr_read_tile_chunk_info(image->context, 0, (int)(x / width),
                                                           (int)(y / height), 0, 0, &chunk);
            if (result != EXR_ERR_SUCCESS) {
                char what[80];
                snprintf(what, sizeof(what), "the file is truncated or damaged at tile (%u, %u)",
                         x / width, y / height);
                return fail(file, result, what, out_error);
            }
            if (!read_chunk(image, file, pipeline, x, y, &chunk, out_error))
                return false;
        }
    return true;
}

static bool decode(struct exr_image *image, const struct exr_file *file, struct error *out_error)
{
    if (!check_storage(image, out_error) || !check_windows(image, out_error) ||
        !check_tiles(image, out_error) || !check_channels(image, out_error))
        return false;
    size_t bytes = (size_t)image->width * image->height * sizeof(float[3]);
    // Zeros, so that nothing of this memory's past is seen should a chunk be smaller than it says.
    image->pixels = calloc(1, bytes);
    if (!image->pixels)
        return error_set(out_error, "out of memory for %zu MiB of texels", bytes >> 20);
    exr_decode_pipeline_t pipeline = EXR_DECODE_PIPELINE_INITIALIZER;
    bool done = image->tiled ? read_tiles(image, file, &pipeline, out_error)
                             : read_scanlines(image, file, &pipeline, out_error);
    exr_decoding_destroy(image->context, &pipeline);
    return done;
}

float *exr_decode(const uint8_t *bytes, size_t size, uint32_t *out_width, uint32_t *out_height,
                  struct error *out_error)
{
    struct exr_file file = {.bytes = bytes, .size = size};
    struct exr_image image = {0};
    exr_context_initializer_t params = EXR_DEFAULT_CONTEXT_INITIALIZER;
    params.error_handler_fn = take_message;
    params.alloc_fn = limited_alloc;
    params.free_fn = free;
    params.user_data = &file;
    params.read_fn = read_bytes;
    params.size_fn = tell_size;
    // Offsets of chunks that are wrong are an error: looking for them elsewhere takes time.
    params.flags = EXR_CONTEXT_FLAG_DISABLE_CHUNK_RECONSTRUCTION;
    exr_result_t result = exr_start_read(&image.context, "environment", &params);
    bool done = result == EXR_ERR_SUCCESS
                    ? decode(&image, &file, out_error)
                    : fail(&file, result, "a damaged OpenEXR file", out_error);
    if (image.context)
        exr_finish(&image.context);
    if (!done) {
        free(image.pixels);
        return NULL;
    }
    *out_width = image.width;
    *out_height = image.height;
    return image.pixels;
}
