// Float images in host memory, and their files.
#ifndef VOXCAST_RENDERER_METRICS_PICTURE_H
#define VOXCAST_RENDERER_METRICS_PICTURE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "renderer/error.h"

#define PICTURE_MAX_EDGE 16384u

struct picture {
    uint32_t width;
    uint32_t height;
    float *rgb; // owned, 3 floats per pixel, row 0 at the top
};

// Zeroed. False when out of memory; then nothing needs finishing.
bool picture_init(struct picture *picture, uint32_t width, uint32_t height);
void picture_finish(struct picture *picture);

static inline size_t picture_pixel_count(const struct picture *picture)
{
    return (size_t)picture->width * picture->height;
}

// Reads a Portable Float Map: "PF", size, scale (negative: little endian), rows from the bottom up,
// either byte order, edges up to PICTURE_MAX_EDGE. False with a message about the file; then
// nothing needs finishing.
bool picture_read_pfm(const char *path, struct picture *out_picture, struct error *out_error);

// False with a message; the file is then removed.
bool picture_write_pfm(const char *path, const struct picture *picture, struct error *out_error);

#endif
