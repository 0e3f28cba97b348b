// Images as files: .pfm, .png and .jpg.
#ifndef VOXCAST_SERVER_ACCURACY_PICTURE_FILE_H
#define VOXCAST_SERVER_ACCURACY_PICTURE_FILE_H

#include "renderer/metrics/picture.h"
#include "renderer/renderer.h"

// Writes pixels by the file's extension: .pfm (FRAME_OUTPUT_LINEAR), .png or .jpg
// (FRAME_OUTPUT_RGBA8).
bool picture_file_write(const char *path, const struct frame_pixels *pixels,
                        struct error *out_error);

// Writes 3 bytes a pixel, row 0 at the top, to a .png.
bool picture_file_write_png(const char *path, uint32_t width, uint32_t height, const uint8_t *rgb,
                            struct error *out_error);

// Converts pixels of FRAME_OUTPUT_LINEAR to an image that the caller owns. False when out of
// memory.
bool picture_from_pixels(const struct frame_pixels *pixels, struct picture *out_picture);

// Whether a name ends in, for example, ".png", in upper or lower case.
bool picture_file_has_extension(const char *path, const char *extension);

// The frame output that a file of this name needs; false if the extension is none of the three.
bool picture_file_output(const char *path, enum frame_output *out_output);

#endif
