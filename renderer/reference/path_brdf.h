// How a surface of the reference path tracer reflects: Lambert under a GGX layer, as glTF 2.0,
// appendix B, defines it and the renderer's shaders/lib/brdf.glsl evaluates it; written anew, with
// random directions besides. Blinn-Phong materials are taken as GGX of the same roughness.
#ifndef VOXCAST_RENDERER_REFERENCE_PATH_BRDF_H
#define VOXCAST_RENDERER_REFERENCE_PATH_BRDF_H

#include "renderer/reference/path_surface.h"

struct path_reflection {
    double share[3]; // BRDF times cosine, per steradian; 0 behind the surface
    double density;  // per steradian, of path_brdf_sample() choosing this direction
};

// For light from `direction` (unit, away from the surface) towards the surface's viewer. False, and
// all 0, if nothing is reflected.
bool path_brdf_evaluate(const struct path_surface *surface, const double direction[3],
                        struct path_reflection *out_reflection);

// A random direction by three random numbers in 0..1. False if it points into the surface.
bool path_brdf_sample(const struct path_surface *surface, const double u[3],
                      double out_direction[3], struct path_reflection *out_reflection);

#endif
