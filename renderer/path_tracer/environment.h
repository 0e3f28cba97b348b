// The environment as a light: its radiance, and directions chosen by how bright it is there.
#ifndef VOXCAST_RENDERER_PATH_TRACER_ENVIRONMENT_H
#define VOXCAST_RENDERER_PATH_TRACER_ENVIRONMENT_H

#include "renderer/path_tracer/vector.h"
#include "renderer/scene/scene.h"

struct environment;

// Reads `source` as long as it lives. NULL when out of memory.
struct environment *environment_create(const struct scene_environment *source);
void environment_destroy(struct environment **environment);

// False if it is black.
bool environment_shines(const struct environment *environment);

// Whether it is so uneven that choosing directions by brightness pays.
bool environment_is_uneven(const struct environment *environment);

// Radiance from a direction (unit), in cd/m^2; pictures are bilinear.
float3 environment_radiance(const struct environment *environment, float3 direction);

// Density per steradian of environment_sample() choosing a direction.
float environment_density(const struct environment *environment, float3 direction);

// A random direction by two random numbers: a cell by its brightness, and evenly within.
float3 environment_sample(const struct environment *environment, const float u[2]);

#endif
