// The reference: an unbiased Monte Carlo path tracer on the CPU, in double precision, that shares
// with the renderer nothing but the scene document, the camera and the ray casts.
//
// Surfaces are Lambertian under GGX (see path_brdf.h). Lights are punctual lights as
// points, every emissive triangle, and the environment. A path's vertex samples lights directly and
// follows one ray by what the surface reflects; emitters are found both ways, weighted by the
// balance heuristic (Veach 1997, "Robust Monte Carlo Methods for Light Transport Simulation").
//
// Single-sided surfaces are as the rasteriser shows them: the camera sees through their backs. All
// other rays stop there and find black, since what casts a shadow in the renderer blocks light
// from both sides, and a side that is never shown has no colour. Blended and transmissive surfaces
// let light pass straight through in proportion, and cast no shadow.
#ifndef VOXCAST_RENDERER_REFERENCE_PATH_TRACER_H
#define VOXCAST_RENDERER_REFERENCE_PATH_TRACER_H

#include "renderer/scene/scene.h"
#include "renderer/settings.h"

#define PATH_BOUNCES_UNLIMITED UINT32_MAX

struct path_params {
    const struct scene *scene;
    struct view_camera camera;
    uint32_t width;
    uint32_t height;
    uint32_t samples;  // paths per pixel
    uint32_t bounces;  // of indirect light: a path is reflected at most 1 + bounces times
    uint64_t seed;     // the same seed gives the same picture, whatever the threads
    uint32_t threads;  // 0: two
    bool pixel_center; // rays through pixel centres; else spread evenly over the pixels
};

// Radiance in cd/m^2, 4 floats a pixel (the last is 1), row 0 at the top.
struct path_picture {
    uint32_t width;
    uint32_t height;
    float *direct;   // emission, background, and light of lamps and emitters reflected once
    float *sky;      // light of the environment reflected once
    float *indirect; // light reflected twice or more
};

// False when out of memory. The caller finishes the picture.
bool path_trace(const struct path_params *params, struct path_picture *out_picture);
void path_picture_finish(struct path_picture *picture);

#endif
