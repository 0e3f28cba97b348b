// As Ward describes the format in "Real Pixels" (Graphics Gems II) and Radiance's manual pages do.
#include "renderer/image/radiance_decode.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "renderer/image/environment_image.h"
#include "renderer/image/image.h"

#define MAX_LINE_BYTES 512
// Narrower and wider lines are never in runs of a component each.
#define MIN_RUN_WIDTH 8u
#define MAX_RUN_WIDTH 32767u

struct reader {
    const uint8_t *at;
    const uint8_t *end;
};

// The next line without its end. False if there is none, or it is longer than any should be.
static bool take_line(struct reader *reader, char line[MAX_LINE_BYTES])
{
    const uint8_t *end = memchr(reader->at, '\n', (size_t)(reader->end - reader->at));
    if (!end || end - reader->at >= MAX_LINE_BYTES)
        return false;
    memcpy(line, reader->at, (size_t)(end - reader->at));
    line[end - reader->at] = '\0';
    reader->at = end + 1;
    return true;
}

static bool take_header(struct reader *reader, uint32_t *out_width, uint32_t *out_height,
                        struct error *out_error)
{
    char line[MAX_LINE_BYTES];
    unsigned width, height;
    bool rgbe = false;
    if (reader->at == reader->end || !take_line(reader, line) ||
        (strcmp(line, "#?RADIANCE") != 0 && strcmp(line, "#?RGBE") != 0))
        return error_set(out_error, "neither a Radiance (.hdr) nor an OpenEXR (.exr) image");
    while (take_line(reader, line) && line[0] != '\0')
        rgbe = rgbe || strcmp(line, "FORMAT=32-bit_rle_rgbe") == 0;
    if (!rgbe)
        return error_set(out_error, "a Radiance image of another format than 32-bit_rle_rgbe");
    if (!take_line(reader, line) || sscanf(line, "-Y %9u +X %9u", &height, &width) != 2)
        return error_set(out_error, "a Radiance image whose size is not \"-Y height +X width\"");
    if (width < 1 || height < 1 || width > IMAGE_MAX_EDGE || height > IMAGE_MAX_EDGE ||
        (uint64_t)width * height * sizeof(float[3]) > ENVIRONMENT_MAX_BYTES)
        return error_set(out_error,
                         "an image of %u x %u texels; allowed are 1 to %u a side and %u MiB of "
                         "floats",
                         width, height, IMAGE_MAX_EDGE, ENVIRONMENT_MAX_BYTES >> 20);
    *out_width = width;
    *out_height = height;
    return true;
}

// One component of all texels of a line.
static bool take_runs(struct reader *reader, uint8_t *rgbe, uint32_t width)
{
    for (uint32_t x = 0; x < width;) {
        if (reader->end - reader->at < 2)
            return false;
        uint32_t count = *reader->at++;
        bool run = count > 128;
        count = run ? count - 128 : count;
        if (count == 0 || count > width - x || reader->end - reader->at < (run ? 1 : (long)count))
            return false;
        for (uint32_t i = 0; i < count; i++)
            rgbe[4 * x++] = reader->at[run ? 0 : i];
        reader->at += run ? 1 : count;
    }
    return true;
}

// Texels one by one; 1, 1, 1, n repeats the one before n times, 256 n times if it comes again, ...
static bool take_flat(struct reader *reader, uint8_t *rgbe, uint32_t width)
{
    uint32_t shift = 0;
    for (uint32_t x = 0; x < width;) {
        if (reader->end - reader->at < 4)
            return false;
        const uint8_t *texel = reader->at;
        reader->at += 4;
        if (texel[0] != 1 || texel[1] != 1 || texel[2] != 1) {
            memcpy(rgbe + 4 * (size_t)x++, texel, 4);
            shift = 0;
            continue;
        }
        uint64_t count = (uint64_t)texel[3] << shift;
        if (x == 0 || shift > 16 || count > width - x)
            return false;
        for (; count > 0; count--, x++)
            memcpy(rgbe + 4 * (size_t)x, rgbe + 4 * (size_t)(x - 1), 4);
        shift += 8;
    }
    return true;
}

static bool take_texels(struct reader *reader, uint8_t *rgbe, uint32_t width)
{
    const uint8_t *at = reader->at;
    bool runs = width >= MIN_RUN_WIDTH && width <= MAX_RUN_WIDTH && reader->end - at >= 4 &&
                at[0] == 2 && at[1] == 2 && at[2] < 128;
    if (!runs)
        return take_flat(reader, rgbe, width);
    if ((uint32_t)(at[2] << 8 | at[3]) != width)
        return false;
    reader->at += 4;
    for (size_t c = 0; c < 4; c++)
        if (!take_runs(reader, rgbe + c, width))
            return false;
    return true;
}

static void convert(const uint8_t *rgbe, float *texels, uint32_t width)
{
    for (size_t x = 0; x < width; x++) {
        float scale = rgbe[4 * x + 3] > 0 ? ldexpf(1.0f, rgbe[4 * x + 3] - 136) : 0.0f;
        for (size_t c = 0; c < 3; c++)
            texels[3 * x + c] = (float)rgbe[4 * x + c] * scale;
    }
}

float *radiance_decode(const uint8_t *bytes, size_t size, uint32_t *out_width, uint32_t *out_height,
                       struct error *out_error)
{
    struct reader reader = {bytes, bytes + size};
    uint32_t width = 1, height = 1; // what refuses does not set them, which clang-tidy cannot see
    if (!take_header(&reader, &width, &height, out_error))
        return NULL;
    uint8_t *rgbe = malloc(4 * (size_t)width);
    float *pixels = malloc((size_t)width * height * sizeof(float[3]));
    bool done = rgbe && pixels;
    if (!done)
        error_set(out_error, "out of memory for %u x %u texels", width, height);
    for (uint32_t y = 0; done && y < height; y++) {
        done = take_texels(&reader, rgbe, width);
        if (done)
            convert(rgbe, pixels + 3 * (size_t)y * width, width);
        else
            error_set(out_error, "a Radiance image that is truncated or damaged at line %u of %u",
                      y, height);
    }
    free(rgbe);
    if (!done) {
        free(pixels);
        return NULL;
    }
    *out_width = width;
    *out_height = height;
    return pixels;
}
