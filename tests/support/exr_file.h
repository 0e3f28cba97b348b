// Writes small OpenEXR files byte by byte, valid and invalid ones: uncompressed, and without the
// library that reads them.
#ifndef VOXCAST_TESTS_SUPPORT_EXR_FILE_H
#define VOXCAST_TESTS_SUPPORT_EXR_FILE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct exr_file_params {
    uint32_t width, height;
    const char *channels; // a letter each, in order of the alphabet, such as "ABGR"
    bool half;            // else float
    uint32_t tile_edge;   // 0: scanlines
    // Replace the correct values unless 0:
    uint32_t told_width, told_height;
    uint32_t display_width;
    uint32_t pixel_type; // 1 + that of the format: 1 is an unsigned integer
    uint32_t sampling;
    bool cube; // claims to be a cube map
};

// `texels` are width x height x 4 values: those of R, G, B and any other channel (Y: of R). The
// caller frees the result; NULL when out of memory.
uint8_t *exr_file_write(const struct exr_file_params *params, const float *texels,
                        size_t *out_size);

#endif
