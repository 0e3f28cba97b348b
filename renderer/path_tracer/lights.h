// A snapshot's lights for next-event estimation: punctual lights (KHR_lights_punctual), as spheres
// that rays cannot hit if they have a radius; and every emissive triangle.
#ifndef VOXCAST_RENDERER_PATH_TRACER_LIGHTS_H
#define VOXCAST_RENDERER_PATH_TRACER_LIGHTS_H

#include "renderer/path_tracer/surface.h"

// NULL when out of memory. Reads the snapshot's scene, instances and materials.
struct lights *lights_create(const struct snapshot *snapshot);
void lights_destroy(struct lights **lights);

bool lights_have_punctual(const struct lights *lights);
bool lights_have_emitters(const struct lights *lights);

// A light's contribution to a point.
struct light_sample {
    float3 direction; // unit, from the point to the light
    float distance;   // INFINITY for directional lights
    float3 light;  // punctual: illuminance (lux) on a plane facing the light, over the probability
                   // of choosing the light; emitters: radiance (cd/m^2)
    float3 lift;   // emitters: unit, from the triangle to the point's side; else 0
    float span;    // emitters: maximum extent of the triangle's edges along an axis
    float density; // emitters: of the direction, per steradian
    bool casts_shadow;
};

// Samples one punctual light by its unshadowed contribution to a point with this normal (on either
// side of the surface if `both_sides`) with two random numbers; two more sample a point of it.
// False if no light contributes.
bool lights_sample_punctual(const struct lights *lights, float3 position, float3 normal,
                            bool both_sides, const float choice[2], const float u[2],
                            struct light_sample *out_sample);

// Samples a point of an emissive triangle, chosen by power, uniform in area. False if no light
// comes from there.
bool lights_sample_emitter(const struct lights *lights, const struct snapshot *snapshot,
                           float3 position, float choice, const float u[2],
                           struct light_sample *out_sample);

// Whether emitters are so few that `choice` may also be the first of the point's two random
// numbers: it is then rescaled within the emitter's interval.
bool lights_are_few(const struct lights *lights);

// Density of lights_sample_emitter() for the direction to a point of an emitter, per steradian.
float lights_emitter_density(const struct lights *lights, const struct surface *emitter,
                             float3 from);

#endif
