// Images of the reference path tracer for tests: one call, all samples.
#ifndef VOXCAST_TESTS_GPU_SUPPORT_PATH_H
#define VOXCAST_TESTS_GPU_SUPPORT_PATH_H

#include "renderer/path_tracer/reference.h"
#include "renderer/scene/scene.h"

#define PATH_BOUNCES_UNLIMITED REFERENCE_UNLIMITED

struct path_params {
    const struct scene *scene;
    struct view_camera camera;
    uint32_t width;
    uint32_t height;
    uint32_t samples;  // paths per pixel
    uint32_t bounces;  // of indirect light: light is reflected at most 1 + bounces times
    uint64_t seed;     // the same seed gives the same image, whatever the threads
    uint32_t threads;  // 0: two
    bool pixel_center; // rays through pixel centres; else spread evenly over the pixels
    enum reference_estimator estimator;
};

// Radiance in cd/m^2, 4 floats a pixel (the last is 1), row 0 at the top.
struct path_picture {
    uint32_t width;
    uint32_t height;
    float *direct;   // emission, background, and the first reflection of lights and emitters
    float *sky;      // the first reflection of the environment
    float *indirect; // light reflected twice or more
};

// False when out of memory. The caller finishes the image.
bool path_trace(const struct path_params *params, struct path_picture *out_picture);
void path_picture_finish(struct path_picture *picture);

#endif
