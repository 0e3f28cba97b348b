// Surface at a hit: the material model of shaders/lib/geometry.glsl, with textures at their finest
// level.
//
// Front faces match the rasteriser: corners run counter-clockwise, also for mirrored transforms.
// The camera never sees the back of a single-sided surface; the caller decides what it means to
// other rays.
#ifndef VOXCAST_RENDERER_PATH_TRACER_SURFACE_H
#define VOXCAST_RENDERER_PATH_TRACER_SURFACE_H

#include "renderer/path_tracer/snapshot.h"

struct surface {
    const struct material *material;
    bool is_front;   // hit from the front
    bool is_back;    // hit from the back of a single-sided surface, which shows and emits nothing
    float3 position; // in the snapshot's coordinates
    float span;      // upper bound of the triangle's extent along an axis
    float3 geometric_normal; // unit, on the ray's side
    float3 normal;           // shading normal, unit, on the same side
    float3 view;             // unit, towards the ray's origin
    float3 base_color;
    float3 f0;       // dielectric layer's, at normal incidence
    float3 emission; // cd/m^2 towards the ray's origin
    float f90;       // at grazing incidence
    float metallic;
    float roughness;
    float alpha;
    float coverage;     // alpha of blended materials; else 1
    float transmission; // transmitted fraction of what is not reflected
};

// `direction` (unit) is the ray's. False if the triangle has no area.
bool surface_init(struct surface *surface, const struct snapshot *snapshot,
                  const struct ray_crossing *crossing, float3 direction);

// Straight transmittance, uncovered or through a thin wall; 0 for most surfaces.
float3 surface_passed(const struct surface *surface);

// Whether the alpha mask cuts a hole here, which rays do not hit.
static inline bool surface_is_hole(const struct surface *surface)
{
    return surface->material->masked && surface->alpha < surface->material->source->alpha_cutoff;
}

#endif
