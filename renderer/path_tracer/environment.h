// The environment as a light: its radiance, and importance sampling of it.
#ifndef VOXCAST_RENDERER_PATH_TRACER_ENVIRONMENT_H
#define VOXCAST_RENDERER_PATH_TRACER_ENVIRONMENT_H

#include "renderer/path_tracer/vector.h"
#include "renderer/scene/scene.h"

struct environment;

// Reads `source` throughout its life. NULL when out of memory.
struct environment *environment_create(const struct scene_environment *source);
void environment_destroy(struct environment **environment);

// False if it is black.
bool environment_shines(const struct environment *environment);

// Whether it is uneven enough for importance sampling to pay.
bool environment_is_uneven(const struct environment *environment);

// Radiance from a direction (unit), in cd/m^2; bilinear for images.
float3 environment_radiance(const struct environment *environment, float3 direction);

// Density of environment_sample() for a direction, per steradian.
float environment_density(const struct environment *environment, float3 direction);

// Samples a direction with two random numbers: a cell by luminance, then uniform in it.
float3 environment_sample(const struct environment *environment, const float u[2]);

#endif
