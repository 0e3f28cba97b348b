#include "server/document/thumbnail.h"

#include <stdbool.h>
#include <stdlib.h>
#include <turbojpeg.h>

#include "protocol/limits.h"

#define THUMBNAIL_QUALITY 85
#define TAPS_PER_AXIS     8u

// A JPEG of RGB bytes, from malloc; NULL on failure.
static uint8_t *encode_jpeg(const uint8_t *rgb, uint32_t width, uint32_t height, int quality,
                            uint32_t *out_bytes)
{
    unsigned long bytes = tjBufSize((int)width, (int)height, TJSAMP_420);
    unsigned char *buffer = malloc(bytes);
    tjhandle handle = tjInitCompress();
    bool fine = buffer && handle &&
                tjCompress2(handle, rgb, (int)width, 0, (int)height, TJPF_RGB, &buffer, &bytes,
                            TJSAMP_420, quality, TJFLAG_NOREALLOC) == 0;
    if (handle)
        tjDestroy(handle);
    if (!fine) {
        free(buffer);
        return NULL;
    }
    *out_bytes = (uint32_t)bytes;
    return buffer;
}

char *base64_encode(const uint8_t *bytes, size_t count)
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    char *text = malloc((count + 2) / 3 * 4 + 1);
    if (!text)
        return NULL;
    char *at = text;
    for (size_t i = 0; i < count; i += 3) {
        size_t left = count - i;
        uint32_t group = (uint32_t)bytes[i] << 16;
        group |= left > 1 ? (uint32_t)bytes[i + 1] << 8 : 0;
        group |= left > 2 ? bytes[i + 2] : 0;
        *at++ = digits[group >> 18];
        *at++ = digits[group >> 12 & 63];
        *at++ = left > 1 ? digits[group >> 6 & 63] : '=';
        *at++ = left > 2 ? digits[group & 63] : '=';
    }
    *at = '\0';
    return text;
}

// The average of texels spread over pixel (x, y) of an image of `width` x `height`.
static void average(const struct image *image, uint32_t width, uint32_t height, uint32_t x,
                    uint32_t y, uint8_t *out_rgb)
{
    uint32_t sums[3] = {0};
    for (uint32_t v = 0; v < TAPS_PER_AXIS; v++) {
        uint64_t row = ((uint64_t)y * TAPS_PER_AXIS + v) * image->height / (height * TAPS_PER_AXIS);
        for (uint32_t u = 0; u < TAPS_PER_AXIS; u++) {
            uint64_t column =
                ((uint64_t)x * TAPS_PER_AXIS + u) * image->width / (width * TAPS_PER_AXIS);
            const uint8_t *texel = image->rgba + (row * image->width + column) * 4;
            for (int c = 0; c < 3; c++)
                sums[c] += texel[c];
        }
    }
    for (int c = 0; c < 3; c++)
        out_rgb[c] = (uint8_t)(sums[c] / (TAPS_PER_AXIS * TAPS_PER_AXIS));
}

bool thumbnail_create(struct image *image, struct thumbnail *out_thumbnail)
{
    uint32_t longer = image->width > image->height ? image->width : image->height;
    uint32_t edge = longer < PROTOCOL_MAX_THUMBNAIL_EDGE ? longer : PROTOCOL_MAX_THUMBNAIL_EDGE;
    uint32_t width = (uint32_t)((uint64_t)image->width * edge / longer);
    uint32_t height = (uint32_t)((uint64_t)image->height * edge / longer);
    width = width > 0 ? width : 1;
    height = height > 0 ? height : 1;
    uint8_t *rgb = malloc((size_t)width * height * 3);
    if (!rgb)
        return false;
    if (!image_pin(image)) {
        free(rgb);
        return false;
    }
    for (uint32_t y = 0; y < height; y++) {
        for (uint32_t x = 0; x < width; x++)
            average(image, width, height, x, y, rgb + ((size_t)y * width + x) * 3);
    }
    image_unpin(image);
    uint32_t bytes = 0;
    uint8_t *jpeg = encode_jpeg(rgb, width, height, THUMBNAIL_QUALITY, &bytes);
    char *base64 = jpeg ? base64_encode(jpeg, bytes) : NULL;
    free(jpeg);
    free(rgb);
    if (!base64)
        return false;
    *out_thumbnail = (struct thumbnail){width, height, base64};
    return true;
}

void thumbnail_finish(struct thumbnail *thumbnail)
{
    free(thumbnail->base64);
    thumbnail->base64 = NULL;
}
