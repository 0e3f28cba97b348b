// The equirectangular image of an environment, shared by reference count between scenes, their
// copies and the steps of undo. It never changes once made.
#ifndef VOXCAST_RENDERER_IMAGE_ENVIRONMENT_IMAGE_H
#define VOXCAST_RENDERER_IMAGE_ENVIRONMENT_IMAGE_H

#include <stddef.h>
#include <stdint.h>

#include "renderer/error.h"

// Of the floats: 8192 x 4096 texels take 384 MiB.
#define ENVIRONMENT_MAX_BYTES (512u << 20)

// Brighter texels are clamped, so that sums over an image stay finite. The sun has 1.6e9 cd/m^2.
#define ENVIRONMENT_MAX_RADIANCE 1e10f

#define ENVIRONMENT_LEVEL_WIDTH  256u
#define ENVIRONMENT_LEVEL_HEIGHT 128u
#define ENVIRONMENT_MAX_LEVELS   9u

// Means over solid angle; width x height x 3 floats.
struct environment_level {
    uint32_t width, height;
    float *pixels; // owned by the image
};

struct environment_image {
    uint32_t references; // changed by atomic operations alone
    uint64_t serial;     // no other image of this process has it
    uint32_t width, height;
    float *pixels;   // linear Rec.709, width x height x 3, row 0 at the top (+Y)
    char *path;      // canonical, for hot reload; owned; NULL if it is of no file
    char name[1024]; // as clients know it
    char warning[200];

    // The image at no more than ENVIRONMENT_LEVEL_WIDTH x ENVIRONMENT_LEVEL_HEIGHT, then halved
    // down to one texel. Light of a texel, however small and bright, is in all of them.
    uint32_t level_count;
    struct environment_level levels[ENVIRONMENT_MAX_LEVELS];
};

// Takes over `pixels` (from malloc) of finite values of at least 0, also on failure. The caller has
// the one reference. NULL when out of memory. Costs one pass over the texels. Any thread.
struct environment_image *environment_image_create(uint32_t width, uint32_t height, float *pixels);

// Decodes Radiance (.hdr) or OpenEXR (.exr), told by content. Texels that are not finite, negative
// or above ENVIRONMENT_MAX_RADIANCE are clamped, with a warning. NULL with a message that says what
// is wrong and what is allowed. Any thread.
struct environment_image *environment_image_decode(const uint8_t *bytes, size_t size,
                                                   struct error *out_error);

// The same of a file. Blocks on disk.
struct environment_image *environment_image_load(const char *path, struct error *out_error);

// Adds a reference and returns `image`, which may be NULL. Any thread.
struct environment_image *environment_image_retain(struct environment_image *image);

// Drops a reference and sets *image to NULL. Any thread.
void environment_image_release(struct environment_image **image);

// Mean radiance about a unit direction, over so many steradians: of the level whose texels are that
// large there.
void environment_image_sample(const struct environment_image *image, const float direction[3],
                              float solid_angle, float out_color[3]);

#endif
