// Benchmarks the path tracer against Embree alone: records the rays of an image, then casts them in
// a bare loop, and by the reference with everything that it takes to render the image.
#ifndef VOXCAST_RENDERER_PATH_TRACER_RAY_BENCH_H
#define VOXCAST_RENDERER_PATH_TRACER_RAY_BENCH_H

#include "renderer/path_tracer/reference.h"

struct ray_rate;

// Records the rays of `samples` samples per pixel. NULL with a message when out of memory.
struct ray_rate *ray_rate_create(const struct reference_params *params, uint32_t samples,
                                 struct error *out_error);
void ray_rate_destroy(struct ray_rate **rate);

struct ray_rate_result {
    uint64_t nearest_rays, shadow_rays;     // of the image
    double bare_seconds, reference_seconds; // wall clock
    double bare_cpu_seconds,
        reference_cpu_seconds; // over all processors: valid on a busy machine, too
};

// Casts all rays both ways, with the reference's number of threads. False with a message when
// memory or threads run out.
bool ray_rate_measure(struct ray_rate *rate, struct ray_rate_result *out_result,
                      struct error *out_error);

#endif
