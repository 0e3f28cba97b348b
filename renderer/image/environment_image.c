#include "renderer/image/environment_image.h"

#include <math.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "renderer/image/file_access.h"
#include "renderer/image/exr_decode.h"
#include "renderer/image/radiance_decode.h"
#include "renderer/image/image.h"

static atomic_uint_fast64_t newest_serial;

// Height of a row's upper edge on the unit sphere. Its solid angle goes by the difference of two.
static double edge_y(uint32_t row, uint32_t height)
{
    return cos(M_PI * row / height);
}

// One axis: what share of a source cell, 0..1, lies in the target cell after the one it begins in.
static double fraction_beyond(double begin, double end, double target_end)
{
    return end > target_end ? (end - target_end) / (end - begin) : 0.0;
}

// Sums a row's columns into wider ones. No column of the source is wider than one of the target.
static void sum_columns(const float *from, uint32_t from_width, double *to, uint32_t to_width)
{
    memset(to, 0, 3 * to_width * sizeof(*to));
    for (uint32_t x = 0; x < from_width; x++) {
        uint32_t column = (uint32_t)((uint64_t)x * to_width / from_width);
        double scale = (double)to_width / from_width;
        double beyond =
            column + 1 < to_width ? fraction_beyond(x * scale, (x + 1) * scale, column + 1.0) : 0.0;
        for (uint32_t c = 0; c < 3; c++) {
            to[3 * column + c] += (1.0 - beyond) * (double)from[3 * x + c] * scale;
            if (beyond > 0.0)
                to[3 * (column + 1) + c] += beyond * (double)from[3 * x + c] * scale;
        }
    }
}

static void add_row(double *sums, const double *row, uint32_t width, double weight)
{
    for (uint32_t i = 0; i < 3 * width; i++)
        sums[i] += row[i] * weight;
}

// Means over solid angle; a texel that lies across cells is shared between them.
static bool reduce(const struct environment_level *from, struct environment_level *to)
{
    double *row = malloc(3 * to->width * sizeof(*row));
    double *sums = calloc((size_t)3 * to->width * to->height, sizeof(*sums));
    to->pixels = malloc((size_t)3 * to->width * to->height * sizeof(float));
    bool done = row && sums && to->pixels;
    for (uint32_t y = 0; done && y < from->height; y++) {
        sum_columns(from->pixels + (size_t)3 * y * from->width, from->width, row, to->width);
        uint32_t target = (uint32_t)((uint64_t)y * to->height / from->height);
        double top = edge_y(y, from->height), bottom = edge_y(y + 1, from->height);
        double beyond = target + 1 < to->height
                            ? fraction_beyond(-top, -bottom, -edge_y(target + 1, to->height))
                            : 0.0;
        double *at = sums + (size_t)3 * target * to->width;
        add_row(at, row, to->width, (1.0 - beyond) * (top - bottom));
        if (beyond > 0.0)
            add_row(at + 3 * to->width, row, to->width, beyond * (top - bottom));
    }
    for (uint32_t y = 0; done && y < to->height; y++) {
        double height = edge_y(y, to->height) - edge_y(y + 1, to->height);
        for (size_t i = (size_t)3 * y * to->width; i < (size_t)3 * (y + 1) * to->width; i++)
            to->pixels[i] = (float)(sums[i] / height);
    }
    free(row);
    free(sums);
    return done;
}

static uint32_t max_side(uint32_t value, uint32_t limit)
{
    return value < limit ? value : limit;
}

static uint32_t half_of(uint32_t value)
{
    return value > 1 ? value / 2 : 1;
}

static bool make_levels(struct environment_image *image)
{
    struct environment_level from = {image->width, image->height, image->pixels};
    struct environment_level next = {.width = max_side(from.width, ENVIRONMENT_LEVEL_WIDTH),
                                     .height = max_side(from.height, ENVIRONMENT_LEVEL_HEIGHT)};
    bool done = true;
    while (done && image->level_count < ENVIRONMENT_MAX_LEVELS) {
        struct environment_level *level = &image->levels[image->level_count++];
        *level = next;
        done = reduce(&from, level);
        if (level->width == 1 && level->height == 1)
            break;
        from = *level;
        next = (struct environment_level){half_of(level->width), half_of(level->height), NULL};
    }
    return done;
}

struct environment_image *environment_image_create(uint32_t width, uint32_t height, float *pixels)
{
    struct environment_image *image = calloc(1, sizeof(*image));
    if (!image) {
        free(pixels);
        return NULL;
    }
    image->references = 1;
    image->serial = atomic_fetch_add(&newest_serial, 1) + 1;
    image->width = width;
    image->height = height;
    image->pixels = pixels;
    if (!make_levels(image))
        environment_image_release(&image);
    return image;
}

struct environment_image *environment_image_retain(struct environment_image *image)
{
    if (image)
        __atomic_fetch_add(&image->references, 1, __ATOMIC_RELAXED);
    return image;
}

void environment_image_release(struct environment_image **image)
{
    struct environment_image *released = *image;
    *image = NULL;
    if (!released || __atomic_fetch_sub(&released->references, 1, __ATOMIC_ACQ_REL) != 1)
        return;
    for (uint32_t i = 0; i < released->level_count; i++)
        free(released->levels[i].pixels);
    free(released->pixels);
    free(released->path);
    free(released);
}

// How many texels had to be clamped.
static size_t clamp_texels(float *pixels, size_t texel_count)
{
    size_t clamped = 0;
    for (size_t i = 0; i < texel_count; i++) {
        bool good = true;
        for (size_t c = 0; c < 3; c++) {
            float value = pixels[3 * i + c];
            if (value >= 0.0f && value <= ENVIRONMENT_MAX_RADIANCE)
                continue;
            good = false;
            // NaN fails both comparisons.
            pixels[3 * i + c] = value > 0.0f ? ENVIRONMENT_MAX_RADIANCE : 0.0f;
        }
        clamped += !good;
    }
    return clamped;
}

struct environment_image *environment_image_decode(const uint8_t *bytes, size_t size,
                                                   struct error *out_error)
{
    uint32_t width, height;
    float *pixels = exr_is_exr(bytes, size)
                        ? exr_decode(bytes, size, &width, &height, out_error)
                        : radiance_decode(bytes, size, &width, &height, out_error);
    if (!pixels)
        return NULL;
    size_t clamped = clamp_texels(pixels, (size_t)width * height);
    struct environment_image *image = environment_image_create(width, height, pixels);
    if (!image) {
        error_set(out_error, "out of memory");
        return NULL;
    }
    if (clamped > 0)
        snprintf(image->warning, sizeof(image->warning),
                 "%zu of %zu texels are no numbers, negative or above %g cd/m^2: they are clamped "
                 "to 0 to %g",
                 clamped, (size_t)width * height, (double)ENVIRONMENT_MAX_RADIANCE,
                 (double)ENVIRONMENT_MAX_RADIANCE);
    return image;
}

struct environment_image *environment_image_load(const char *path, struct error *out_error)
{
    uint8_t *bytes = NULL;
    size_t size;
    if (!asset_read_file(path, FILE_MAX_BYTES, &bytes, &size, NULL, out_error))
        return NULL;
    struct error cause;
    struct environment_image *image = environment_image_decode(bytes, size, &cause);
    free(bytes);
    if (!image) {
        error_set(out_error, "environment '%.200s': %.300s", path, cause.message);
        return NULL;
    }
    image->path = realpath(path, NULL);
    const char *slash = strrchr(path, '/');
    snprintf(image->name, sizeof(image->name), "%s", slash ? slash + 1 : path);
    return image;
}

// Between texels, which repeat across and end at the poles.
static void sample_level(const struct environment_level *level, float u, float v,
                         float out_color[3])
{
    float x = u * (float)level->width - 0.5f + (float)level->width;
    float y = v * (float)level->height - 0.5f;
    y = fminf(fmaxf(y, 0.0f), (float)(level->height - 1));
    uint32_t left = (uint32_t)x % level->width, right = (left + 1) % level->width;
    uint32_t top = (uint32_t)y, bottom = max_side(top + 1, level->height - 1);
    float across = x - floorf(x), down = y - floorf(y);
    const float *upper = level->pixels + (size_t)3 * top * level->width;
    const float *lower = level->pixels + (size_t)3 * bottom * level->width;
    for (uint32_t c = 0; c < 3; c++) {
        float a = upper[3 * left + c] * (1.0f - across) + upper[3 * right + c] * across;
        float b = lower[3 * left + c] * (1.0f - across) + lower[3 * right + c] * across;
        out_color[c] = a * (1.0f - down) + b * down;
    }
}

static float texel_solid_angle(const struct environment_level *level, float sine)
{
    float height = (float)level->height;
    return 2.0f * (float)(M_PI * M_PI) * fmaxf(sine, 0.5f / height) / (float)level->width / height;
}

void environment_image_sample(const struct environment_image *image, const float direction[3],
                              float solid_angle, float out_color[3])
{
    float u = 0.5f + atan2f(direction[0], -direction[2]) / (2.0f * (float)M_PI);
    float y = fminf(fmaxf(direction[1], -1.0f), 1.0f);
    float v = acosf(y) / (float)M_PI;
    float sine = sqrtf(1.0f - y * y);
    uint32_t i = 0;
    // The next level is nearer if its texels, four times as large, are not twice too large.
    while (i + 1 < image->level_count &&
           texel_solid_angle(&image->levels[i + 1], sine) < 2.0f * solid_angle)
        i++;
    sample_level(&image->levels[i], u, v, out_color);
}
