// The path-traced images that others are compared with: traced, kept in a folder, or loaded.
#ifndef VOXCAST_SERVER_ACCURACY_REFERENCE_IMAGE_H
#define VOXCAST_SERVER_ACCURACY_REFERENCE_IMAGE_H

#include "renderer/metrics/picture.h"
#include "server/accuracy/progress.h"
#include "server/accuracy/shot.h"

// The images to compare with. All but the first have no pixels where they are not known.
enum reference_picture {
    REFERENCE_IMAGE_ALL,
    REFERENCE_IMAGE_DIRECT, // emission, background, and the first reflection of lights and emitters
    // Of one half of the samples. The halves are independent. So a half differs from the whole as
    // much as the whole differs from an image without noise: by half of the difference between the
    // halves.
    REFERENCE_IMAGE_HALF,
    REFERENCE_IMAGE_HALF_DIRECT,
    REFERENCE_IMAGE_PICTURE_COUNT
};

struct reference_image {
    struct picture pictures[REFERENCE_IMAGE_PICTURE_COUNT];
    double noise; // standard error over mean luminance; NaN if unknown
};

struct reference_image_params {
    const struct shot *shot;
    const char *path, *direct_path; // files; NULL to trace
    uint32_t samples;               // per pixel, if until_noise is 0
    double until_noise;             // trace until the noise is no higher than this
    double max_s;                   // or for this long; 0: no limit
    const char *folder;             // where a traced image is kept and found again, or NULL
    const struct cJSON *identity;   // says which scene and view is traced
    bool low_priority;              // lets all other threads go first
    struct accuracy_watch watch;
};

// Loads or traces the reference image. Tracing uses all processors. False with a message, such as
// that a file is of another size or that the watch ended the run; then nothing needs finishing.
bool reference_image_get(const struct reference_image_params *params,
                         struct reference_image *out_reference, struct error *out_error);
void reference_image_finish(struct reference_image *reference_image);

#endif
