// What a ray of the reference path tracer finds where it hits a scene.
//
// Sides are those of the rasteriser: the front is the side from which the corners run
// counter-clockwise, mirrored placements included. The back of a single-sided surface is never
// shown to the camera; whoever follows a ray decides what it is to that ray.
#ifndef VOXCAST_RENDERER_REFERENCE_PATH_SURFACE_H
#define VOXCAST_RENDERER_REFERENCE_PATH_SURFACE_H

#include "renderer/scene/ray_scene.h"

struct path_surface {
    uint32_t material;
    bool is_back;               // of a single-sided surface: shows and emits nothing
    bool unlit;                 // `emission` is what the camera sees; lights nothing
    double position[3];         // world
    double geometric_normal[3]; // unit, on the ray's side
    double normal[3];           // of vertices and normal map, unit, turned likewise
    double view[3];             // unit, towards the ray's origin
    double base_color[3];
    double metallic;
    double roughness;
    double f0[3];          // of the dielectric layer, at normal incidence
    double f90;            // at grazing incidence
    double emission[3];    // cd/m^2 towards the ray's origin
    double passed;         // probability that light passes straight through, as if not there
    double passed_tint[3]; // colour of what passes
};

// `direction` is the ray's. Of the hit, node, primitive, triangle, material and barycentric count.
// False if the triangle has no area. Values are those of factors, vertex colours and textures,
// these at their finest level.
bool path_surface_init(struct path_surface *surface, const struct scene *scene,
                       const struct ray_hit *hit, const double direction[3]);

// Corners of a triangle in world space, and its normal (length: twice the area).
void path_triangle_corners(const struct scene *scene, const struct ray_hit *hit,
                           double out_corners[3][3], double out_area_normal[3]);

#endif
