// What a ray of the path tracer finds where it meets a triangle: the material model of
// shaders/lib/geometry.glsl, with textures at their finest level.
//
// Sides are those of the rasteriser: the front is the side from which the corners run
// counter-clockwise, mirrored placements included. The back of a single-sided surface is never
// shown to the camera; whoever follows a ray decides what it is to that ray.
#ifndef VOXCAST_RENDERER_PATH_TRACER_SURFACE_H
#define VOXCAST_RENDERER_PATH_TRACER_SURFACE_H

#include "renderer/path_tracer/snapshot.h"

struct surface {
    const struct material *material;
    bool is_front;           // the ray meets the front
    bool is_back;            // and if not, the surface is single-sided: it shows and emits nothing
    float3 position;         // of the snapshot
    float span;              // the longest that an edge of its triangle is along an axis, or more
    float3 geometric_normal; // unit, on the ray's side
    float3 normal;           // of vertices and normal map, unit, turned likewise
    float3 view;             // unit, towards the ray's origin
    float3 base_color;
    float3 f0;       // of the dielectric layer, at normal incidence
    float3 emission; // cd/m^2 towards the ray's origin
    float f90;       // at grazing incidence
    float metallic;
    float roughness;
    float alpha;
    float coverage;     // by alpha, of blended materials; else 1
    float transmission; // share of what the surface does not reflect that goes through
};

// `direction` (unit) is the ray's. False if the triangle has no area.
bool surface_init(struct surface *surface, const struct snapshot *snapshot,
                  const struct ray_crossing *crossing, float3 direction);

// Colour of the light that goes straight through, as if nothing were there or as through a thin
// wall; 0 for most surfaces.
float3 surface_passed(const struct surface *surface);

// Whether the alpha mask leaves nothing here; rays do not hit such places.
static inline bool surface_is_hole(const struct surface *surface)
{
    return surface->material->masked && surface->alpha < surface->material->source->alpha_cutoff;
}

#endif
