// Image files.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <turbojpeg.h>

#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb_image_write.h>
#pragma GCC diagnostic pop

#include "server/accuracy/picture_file.h"

#include "renderer/metrics/picture.h"

#define JPEG_FILE_QUALITY 95

bool picture_file_has_extension(const char *path, const char *extension)
{
    size_t length = strlen(path), suffix = strlen(extension);
    return length > suffix && strcasecmp(path + length - suffix, extension) == 0;
}

bool picture_file_output(const char *path, enum frame_output *out_output)
{
    if (picture_file_has_extension(path, ".pfm"))
        *out_output = FRAME_OUTPUT_LINEAR;
    else if (picture_file_has_extension(path, ".png") || picture_file_has_extension(path, ".jpg") ||
             picture_file_has_extension(path, ".jpeg"))
        *out_output = FRAME_OUTPUT_RGBA8;
    else
        return false;
    return true;
}

bool picture_from_pixels(const struct frame_pixels *pixels, struct picture *out_picture)
{
    if (!picture_init(out_picture, pixels->width, pixels->height))
        return false;
    float *target = out_picture->rgb;
    for (uint32_t y = 0; y < pixels->height; y++) {
        const float *source =
            (const float *)(pixels->planes[0] + (size_t)y * pixels->row_pitch_bytes[0]);
        for (uint32_t x = 0; x < pixels->width; x++, target += 3)
            memcpy(target, source + 4 * x, 3 * sizeof(float));
    }
    return true;
}

static bool write_pfm(const char *path, const struct frame_pixels *pixels, struct error *out_error)
{
    struct picture picture;
    if (!picture_from_pixels(pixels, &picture))
        return error_set(out_error, "out of memory");
    bool done = picture_write_pfm(path, &picture, out_error);
    picture_finish(&picture);
    return done;
}

static bool write_jpeg(FILE *file, const struct frame_pixels *pixels)
{
    tjhandle compressor = tjInitCompress();
    unsigned char *bytes = NULL;
    unsigned long size = 0;
    bool done =
        compressor && tjCompress2(compressor, pixels->planes[0], (int)pixels->width,
                                  (int)pixels->row_pitch_bytes[0], (int)pixels->height, TJPF_RGBX,
                                  &bytes, &size, TJSAMP_444, JPEG_FILE_QUALITY, 0) == 0;
    done = done && fwrite(bytes, 1, size, file) == size;
    tjFree(bytes);
    if (compressor)
        tjDestroy(compressor);
    return done;
}

static void append_to_file(void *file, void *data, int size)
{
    fwrite(data, 1, (size_t)size, file);
}

static bool write_png(FILE *file, const struct frame_pixels *pixels)
{
    // Alpha has no meaning here: the image is opaque.
    uint8_t *rgb = malloc((size_t)pixels->width * pixels->height * 3);
    if (!rgb)
        return false;
    for (uint32_t y = 0; y < pixels->height; y++) {
        const uint8_t *source = pixels->planes[0] + (size_t)y * pixels->row_pitch_bytes[0];
        uint8_t *target = rgb + (size_t)y * pixels->width * 3;
        for (uint32_t x = 0; x < pixels->width; x++)
            memcpy(target + 3 * x, source + 4 * x, 3);
    }
    bool done = stbi_write_png_to_func(append_to_file, file, (int)pixels->width,
                                       (int)pixels->height, 3, rgb, 0) != 0;
    free(rgb);
    return done;
}

// Closes the file; removes it if it could not be written in full.
static bool close_file(FILE *file, const char *path, bool done, struct error *out_error)
{
    done = !ferror(file) && done;
    if (fclose(file) == 0 && done)
        return true;
    remove(path);
    return error_set(out_error, "cannot write all of \"%s\" (disk full?)", path);
}

bool picture_file_write(const char *path, const struct frame_pixels *pixels,
                        struct error *out_error)
{
    if (pixels->output == FRAME_OUTPUT_LINEAR)
        return write_pfm(path, pixels, out_error);
    FILE *file = fopen(path, "wb");
    if (!file)
        return error_set(out_error, "cannot write \"%s\": %m", path);
    bool done = picture_file_has_extension(path, ".png") ? write_png(file, pixels)
                                                         : write_jpeg(file, pixels);
    return close_file(file, path, done, out_error);
}

bool picture_file_write_png(const char *path, uint32_t width, uint32_t height, const uint8_t *rgb,
                            struct error *out_error)
{
    FILE *file = fopen(path, "wb");
    if (!file)
        return error_set(out_error, "cannot write \"%s\": %m", path);
    bool done =
        stbi_write_png_to_func(append_to_file, file, (int)width, (int)height, 3, rgb, 0) != 0;
    return close_file(file, path, done, out_error);
}
