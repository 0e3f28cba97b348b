// How fast the path tracer is against Embree alone: the rays of a picture are recorded once, then
// cast in a bare loop and, with all that makes a picture of them, by the reference.
#ifndef VOXCAST_RENDERER_PATH_TRACER_RAY_BENCH_H
#define VOXCAST_RENDERER_PATH_TRACER_RAY_BENCH_H

#include "renderer/path_tracer/reference.h"

struct ray_rate;

// Records the rays of `samples` samples per pixel. NULL with a message when out of memory.
struct ray_rate *ray_rate_create(const struct reference_params *params, uint32_t samples,
                                 struct error *out_error);
void ray_rate_destroy(struct ray_rate **rate);

struct ray_rate_result {
    uint64_t nearest_rays, shadow_rays;             // of the picture
    double bare_seconds, reference_seconds;         // of the wall clock
    double bare_cpu_seconds, reference_cpu_seconds; // of all processors: on a busy machine, too
};

// Casts all rays both ways, with as many threads as the reference has. False with a message when
// memory or threads run out.
bool ray_rate_measure(struct ray_rate *rate, struct ray_rate_result *out_result,
                      struct error *out_error);

#endif
