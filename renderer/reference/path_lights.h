// The lights of a scene as the reference path tracer samples them: punctual lights as
// KHR_lights_punctual defines them, every emissive triangle, and the environment.
#ifndef VOXCAST_RENDERER_REFERENCE_PATH_LIGHTS_H
#define VOXCAST_RENDERER_REFERENCE_PATH_LIGHTS_H

#include "renderer/scene/ray_scene.h"

struct path_lights;

// NULL when out of memory. The scene must outlive the result.
struct path_lights *path_lights_create(const struct scene *scene);
void path_lights_destroy(struct path_lights **lights);

// What one light sends to a point.
struct path_light_sample {
    double direction[3]; // unit, from the point to the light
    double distance;     // infinite for directional lights
    double light[3];     // punctual: illuminance (lux) on a plane facing the light, over the
                         // probability of having been chosen
    bool casts_shadow;
};

// Chooses one punctual light by what each would give to the point with this normal if nothing
// stood between, by the random number `u` in 0..1. False if none gives anything.
bool path_lights_choose_punctual(const struct path_lights *lights, const double position[3],
                                 const double normal[3], double u,
                                 struct path_light_sample *out_sample);

// A random point of an emissive triangle, chosen by power, uniform in its area, by three random
// numbers in 0..1: fills node, primitive, triangle, material and barycentric. False if nothing
// emits. Its density per square metre is path_lights_emitter_density() of its material.
bool path_lights_choose_emitter(const struct path_lights *lights, const double u[3],
                                struct ray_hit *out_point);
double path_lights_emitter_density(const struct path_lights *lights, uint32_t material);

// Radiance of the environment from a direction (unit), in cd/m^2.
void path_environment(const struct scene *scene, const double direction[3], double out_radiance[3]);

#endif
