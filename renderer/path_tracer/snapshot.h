// A scene as the path tracer sees it: an immutable copy of what light depends on.
//
// Geometry, placements, materials, lights and environment are copied, pictures are shared by
// reference count (they never change). Everything is moved so that the middle of the scene's bounds
// lies in the origin, where floats are fine: `origin` has been subtracted. See reference.h for how
// snapshots are made.
#ifndef VOXCAST_RENDERER_PATH_TRACER_SNAPSHOT_H
#define VOXCAST_RENDERER_PATH_TRACER_SNAPSHOT_H

#include <stddef.h>

#include "renderer/path_tracer/reference.h"
#include "renderer/path_tracer/texture.h"
#include "renderer/scene/ray_scene.h"

// A node's placement.
struct instance {
    float3 columns[4];        // of world_from_local
    float3 normal_columns[3]; // cofactors, which turn normals outwards of mirrored placements, too
    float stretch;            // the most that it makes anything longer, or more
    bool mirrored;
};

// A material, prepared. Lane 3 of base_color is alpha.
struct material {
    const struct scene_material *source;
    float3 base_color;
    float3 emission; // cd/m^2, without its texture
    float3 specular_color;
    float3 absorption; // per metre of the body's inside
    float metallic, roughness, normal_scale;
    float f0;  // from the IOR
    float f90; // at grazing incidence, before the specular weight
    float ior; // of bodies that refract, at least MIN_REFRACTING_IOR
    float specular;
    float transmission;
    bool unlit, blinn_phong, double_sided, masked, blends;
    bool transmits;    // some of what a dielectric does not reflect goes through
    bool refracts;     // transmits into a body; else through a thin wall
    bool lets_through; // straight: blended, or a thin wall
    bool emits;
    float emitted_luminance; // mean over its texture
    uint32_t texture_mask;   // bits of enum scene_texture_slot
    struct texture textures[SCENE_TEXTURE_SLOT_COUNT];
};

struct lights;
struct environment;

struct snapshot {
    uint32_t references; // changed by atomic operations alone
    struct scene *scene; // the copy; nodes without names, no cameras, no animations
    struct ray_scene *rays;
    struct instance *instances; // by node
    struct material *materials;
    struct lights *lights;
    struct environment *environment;
    bool all_blinn_phong;
    double origin[3];
    float diagonal_m;
    bool has_bodies; // some material refracts
};

static inline float3 instance_point(const struct instance *instance, float3 local)
{
    return instance->columns[0] * local[0] + instance->columns[1] * local[1] +
           instance->columns[2] * local[2] + instance->columns[3];
}

static inline float3 instance_vector(const struct instance *instance, float3 local)
{
    return instance->columns[0] * local[0] + instance->columns[1] * local[1] +
           instance->columns[2] * local[2];
}

static inline float3 instance_normal(const struct instance *instance, float3 local)
{
    return instance->normal_columns[0] * local[0] + instance->normal_columns[1] * local[1] +
           instance->normal_columns[2] * local[2];
}

static inline const struct material *snapshot_material(const struct snapshot *snapshot,
                                                       uint32_t primitive)
{
    return &snapshot->materials[snapshot->scene->primitives[primitive].material];
}

static inline const uint32_t *snapshot_triangle(const struct snapshot *snapshot, uint32_t primitive,
                                                uint32_t triangle)
{
    return snapshot->scene->indices + snapshot->scene->primitives[primitive].index_first +
           (size_t)triangle * 3;
}

#endif
