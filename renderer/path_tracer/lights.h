// The lights of a snapshot that can be aimed at: punctual lights as KHR_lights_punctual defines
// them, those with a radius as spheres that no ray can hit; and every emissive triangle.
#ifndef VOXCAST_RENDERER_PATH_TRACER_LIGHTS_H
#define VOXCAST_RENDERER_PATH_TRACER_LIGHTS_H

#include "renderer/path_tracer/surface.h"

// NULL when out of memory. Reads the snapshot's scene, instances and materials.
struct lights *lights_create(const struct snapshot *snapshot);
void lights_destroy(struct lights **lights);

bool lights_have_punctual(const struct lights *lights);
bool lights_have_emitters(const struct lights *lights);

// What one light sends to a point.
struct light_sample {
    float3 direction; // unit, from the point to the light
    float distance;   // INFINITY for directional lights
    float3 light;     // punctual: illuminance (lux) on a plane facing the light, over the
                      // probability of having been chosen; emitters: radiance (cd/m^2)
    float3 lift;      // of emitters: unit, from the triangle to the point's side; else 0
    float span;       // of emitters: the longest that the triangle's edges are along an axis
    float density;    // of emitters: of the direction, per steradian
    bool casts_shadow;
};

// Chooses one punctual light by what each would give to a point with this normal if nothing stood
// between (on either side of the surface, if `both_sides`), by two random numbers; two more pick a
// point of it. False if none gives anything.
bool lights_sample_punctual(const struct lights *lights, float3 position, float3 normal,
                            bool both_sides, const float choice[2], const float u[2],
                            struct light_sample *out_sample);

// A random point of an emissive triangle, chosen by power, uniform in its area. False if nothing
// comes from there.
bool lights_sample_emitter(const struct lights *lights, const struct snapshot *snapshot,
                           float3 position, float choice, const float u[2],
                           struct light_sample *out_sample);

// Whether emitters are so few that `choice` may be the first of the point's two random numbers: it
// is spread anew within the emitter's share then.
bool lights_are_few(const struct lights *lights);

// Density per steradian of lights_sample_emitter() choosing the direction to a point of an emitter.
float lights_emitter_density(const struct lights *lights, const struct surface *emitter,
                             float3 from);

#endif
