#include "renderer/image/image_decode.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>
#include <webp/decode.h>

#include "renderer/image/image.h"

// Maximum size of an allocation for the image that this thread decodes: a compressed stream may
// claim far more data than its image holds, and stb would allocate it.
static _Thread_local size_t allocation_limit_bytes;

#ifndef __clang_analyzer__ // findings in stb are not ours to fix
static void *limited_realloc(void *old, size_t size)
{
    return size > allocation_limit_bytes ? NULL : realloc(old, size);
}

#define STB_IMAGE_IMPLEMENTATION
#endif

#define STBI_MALLOC(size)       limited_realloc(NULL, size)
#define STBI_REALLOC(old, size) limited_realloc(old, size)
#define STBI_FREE(old)          free(old)
#define STBI_ONLY_PNG
#define STBI_ONLY_JPEG
#define STBI_ONLY_TGA
#define STBI_ONLY_BMP
#define STBI_NO_STDIO
#define STBI_MAX_DIMENSIONS IMAGE_MAX_EDGE
#define STB_IMAGE_STATIC
#pragma GCC diagnostic ignored "-Wunused-function" // stb declares more than these options define
#include <stb_image.h>

static bool is_webp(const uint8_t *bytes, size_t size)
{
    return size >= 12 && memcmp(bytes, "RIFF", 4) == 0 && memcmp(bytes + 8, "WEBP", 4) == 0;
}

bool image_decode_size(const uint8_t *bytes, size_t size, uint32_t *out_width, uint32_t *out_height,
                       struct error *out_error)
{
    int width = 0, height = 0, channels = 0;
    if (size > INT_MAX) {
        return error_set(out_error, "an image file of %zu bytes; the limit is %d", size, INT_MAX);
    }
    allocation_limit_bytes = 1 << 20; // a header needs little
    bool known = is_webp(bytes, size)
                     ? WebPGetInfo(bytes, size, &width, &height)
                     : stbi_info_from_memory(bytes, (int)size, &width, &height, &channels);
    if (!known) {
        return error_set(out_error,
                         "not an image that can be read (PNG, JPEG, WebP, TGA or BMP), or it is "
                         "damaged or larger than %u pixels a side",
                         IMAGE_MAX_EDGE);
    }
    if (width < 1 || height < 1 || width > (int)IMAGE_MAX_EDGE || height > (int)IMAGE_MAX_EDGE ||
        (uint64_t)width * (uint64_t)height * 4 > IMAGE_MAX_BYTES) {
        return error_set(out_error,
                         "an image of %d x %d pixels; allowed are 1 to %u a side and %u MiB "
                         "when decoded",
                         width, height, IMAGE_MAX_EDGE, IMAGE_MAX_BYTES >> 20);
    }
    *out_width = (uint32_t)width;
    *out_height = (uint32_t)height;
    return true;
}

static uint8_t *decode_webp(const uint8_t *bytes, size_t size, uint32_t width, uint32_t height)
{
    size_t byte_count = (size_t)width * height * 4;
    uint8_t *rgba = byte_count ? malloc(byte_count) : NULL;
    if (rgba && !WebPDecodeRGBAInto(bytes, size, rgba, byte_count, (int)width * 4)) {
        free(rgba);
        return NULL;
    }
    return rgba;
}

static uint8_t *decode_stb(const uint8_t *bytes, size_t size, uint32_t width, uint32_t height)
{
    int got_width = 0, got_height = 0, channels = 0;
    // 16 bits in 4 channels and a filter byte per row; doubled, since stb's buffers grow by
    // doubling.
    allocation_limit_bytes = 2 * ((size_t)width * height * 8 + height) + (1 << 20);
    uint8_t *rgba = stbi_load_from_memory(bytes, (int)size, &got_width, &got_height, &channels, 4);
    if (rgba && (got_width != (int)width || got_height != (int)height)) {
        free(rgba);
        return NULL;
    }
    return rgba;
}

struct image *image_decode(const uint8_t *bytes, size_t size, struct error *out_error)
{
    uint32_t width = 0, height = 0;
    if (!image_decode_size(bytes, size, &width, &height, out_error)) {
        return NULL;
    }
    uint8_t *rgba = is_webp(bytes, size) ? decode_webp(bytes, size, width, height)
                                         : decode_stb(bytes, size, width, height);
    if (!rgba) {
        error_set(out_error, "a damaged image of %u x %u pixels, or out of memory", width, height);
        return NULL;
    }
    struct image *image = image_create(width, height, rgba);
    if (!image) {
        free(rgba);
        error_set(out_error, "out of memory");
    }
    return image;
}
