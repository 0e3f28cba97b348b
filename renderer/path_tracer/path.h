// A camera path: the reference's estimator.
//
// Each vertex samples one punctual light, one emitter and one environment direction, and one ray by
// the BSDF. Light found both ways is weighted by the power heuristic (Veach 1997, "Robust Monte
// Carlo Methods for Light Transport Simulation"). Russian roulette ends paths of low throughput.
//
// Single-sided surfaces match the rasteriser: the camera sees through their backs. All other rays
// stop there and return black, since shadow casters block light from both sides in the renderer and
// a hidden side has no colour. Blended surfaces and thin walls transmit straight through in
// proportion, from both sides. Bodies (transmission and a thickness) refract at both sides, tint
// where light enters, and absorb inside; they cast shadows, which refracted light brightens.
// Caustics of punctual lights are blurred at first and sharpen with the number of samples.
#ifndef VOXCAST_RENDERER_PATH_TRACER_PATH_H
#define VOXCAST_RENDERER_PATH_TRACER_PATH_H

#include "renderer/camera.h"
#include "renderer/path_tracer/reference.h"
#include "renderer/path_tracer/snapshot.h"

// Shared by all paths of an image.
struct path_setup {
    const struct snapshot *snapshot;
    struct camera_frame camera;
    float3 eye; // in the snapshot's coordinates
    uint32_t width, height;
    uint32_t max_bounces;
    uint32_t layer_count;
    uint64_t seed;
    bool pixel_center;
    bool aims_at_emitters, aims_at_environment;
    bool finds_light; // BSDF rays count as well
    bool rays_find;   // and there is light for them to hit
    uint32_t uses;    // bits of the random-number pairs that a vertex uses
};

void path_setup_init(struct path_setup *setup, const struct reference_params *params);

// Count of the rays cast and, if `log` has room, the rays.
struct path_rays {
    uint64_t nearest;
    uint64_t shadow;
    struct ray_load *log; // NULL for none
    uint64_t log_capacity;
};

// A rectangle of pixels.
struct path_tile {
    uint32_t x, y, width, height; // at most PATH_BATCH_SIZE pixels
};
#define PATH_BATCH_SIZE RAY_BATCH_SIZE

// Adds the radiance of one sample per pixel to `layers` (layer_count per pixel, pixel by pixel), in
// cd/m^2. The paths advance together, so that rays are cast in batches.
void path_add_samples(const struct path_setup *setup, struct path_rays *rays,
                      const struct path_tile *tile, uint32_t sample, float3 *layers);

#endif
