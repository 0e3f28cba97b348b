// The path-traced images that others are compared with: traced, kept in a folder, or loaded.
#ifndef VOXCAST_SERVER_ACCURACY_REFERENCE_IMAGE_H
#define VOXCAST_SERVER_ACCURACY_REFERENCE_IMAGE_H

#include "renderer/metrics/picture.h"
#include "server/accuracy/progress.h"
#include "server/accuracy/shot.h"

// What images are compared with. Those but the first have no pixels if they are not known.
enum reference_picture {
    REFERENCE_IMAGE_ALL,
    REFERENCE_IMAGE_DIRECT, // emission, background, and light of lights and emitters reflected once
    // Of one half of the samples. It differs from the whole as much as the whole does from what it
    // would be without noise: the halves are independent, so that half of their difference is both.
    REFERENCE_IMAGE_HALF,
    REFERENCE_IMAGE_HALF_DIRECT,
    REFERENCE_IMAGE_PICTURE_COUNT
};

struct reference_image {
    struct picture pictures[REFERENCE_IMAGE_PICTURE_COUNT];
    double noise; // standard error over mean luminance; NaN if that is not known
};

struct reference_image_params {
    const struct shot *shot;
    const char *path, *direct_path; // files; NULL to trace
    uint32_t samples;               // a pixel, if until_noise is 0
    double until_noise;             // trace until the noise is no more than this
    double max_s;                   // or for so long; 0: however long that takes
    const char *folder;             // where a traced image is kept, and found again, or NULL
    const struct cJSON *identity;   // says what scene and view is traced
    bool low_priority;              // gives way to all others
    struct accuracy_watch watch;
};

// Loads or traces the reference image. Tracing takes all processors. False with a message, such as
// that a file is of another size, or that the watch ended it; then nothing needs finishing.
bool reference_image_get(const struct reference_image_params *params,
                         struct reference_image *out_reference, struct error *out_error);
void reference_image_finish(struct reference_image *reference_image);

#endif
