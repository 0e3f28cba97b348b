// One path of light, from the camera backwards: the estimator of the reference.
//
// At each vertex one punctual light, one emitter and one direction of the environment are aimed at,
// and one ray follows what the surface scatters; light found both ways is weighted by the power
// heuristic (Veach 1997, "Robust Monte Carlo Methods for Light Transport Simulation"). Paths end by
// chance (Russian roulette) once they carry little.
//
// Single-sided surfaces are as the rasteriser shows them: the camera sees through their backs. All
// other rays stop there and find black, since what casts a shadow in the renderer blocks light from
// both sides, and a side that is never shown has no colour. Blended surfaces and thin walls let
// light pass straight through in proportion, from both sides likewise. Bodies (transmission and a
// thickness) refract at both of their sides, tint where light enters, and absorb on the way; they
// cast shadows, which light that they refract brightens. Caustics of punctual lights are blurred at
// first and sharpen with the number of samples.
#ifndef VOXCAST_RENDERER_PATH_TRACER_PATH_H
#define VOXCAST_RENDERER_PATH_TRACER_PATH_H

#include "renderer/camera.h"
#include "renderer/path_tracer/reference.h"
#include "renderer/path_tracer/snapshot.h"

// What all paths of a picture share.
struct path_setup {
    const struct snapshot *snapshot;
    struct camera_frame camera;
    float3 eye; // in the snapshot's space
    uint32_t width, height;
    uint32_t max_bounces;
    uint32_t layer_count;
    uint64_t seed;
    bool pixel_center;
    bool aims_at_emitters, aims_at_environment;
    bool finds_light; // rays that follow the surface count, too
    bool rays_find;   // and there is light that they could find
    uint32_t uses;    // of pairs of random numbers at a vertex, as bits
};

void path_setup_init(struct path_setup *setup, const struct reference_params *params);

// Rays that have been cast, and if `log` has room, what they were.
struct path_rays {
    uint64_t nearest;
    uint64_t shadow;
    struct ray_load *log; // NULL for none
    uint64_t log_capacity;
};

// A rectangle of pixels of the picture.
struct path_tile {
    uint32_t x, y, width, height; // at most PATH_BATCH_SIZE pixels
};
#define PATH_BATCH_SIZE RAY_BATCH_SIZE

// Adds the radiance of one sample of each pixel to `layers` (layer_count of them, pixel by pixel),
// in cd/m^2. Their paths advance together, so that rays are cast together.
void path_add_samples(const struct path_setup *setup, struct path_rays *rays,
                      const struct path_tile *tile, uint32_t sample, float3 *layers);

#endif
