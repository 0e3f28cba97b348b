// Immutable copy of what light depends on in a scene, for the path tracer.
//
// Copies geometry, transforms, materials, lights and environment; shares images, which never
// change, by reference count. Coordinates are relative to `origin`, the centre of the scene's
// bounds, where floats are precise. See reference.h for how snapshots are created.
#ifndef VOXCAST_RENDERER_PATH_TRACER_SNAPSHOT_H
#define VOXCAST_RENDERER_PATH_TRACER_SNAPSHOT_H

#include <stddef.h>

#include "renderer/path_tracer/reference.h"
#include "renderer/path_tracer/texture.h"
#include "renderer/scene/pinned_images.h"
#include "renderer/scene/ray_scene.h"

// A node's transform.
struct instance {
    float3 columns[4];        // of world_from_local
    float3 normal_columns[3]; // cofactors, which keep normals outward when mirrored
    float stretch;            // upper bound of the stretch
    bool mirrored;
};

// A prepared material. Lane 3 of base_color is alpha.
struct material {
    const struct scene_material *source;
    float3 base_color;
    float3 emission; // cd/m^2, without texture
    float3 specular_color;
    float3 absorption; // inside the body, per metre
    float metallic, roughness, normal_scale;
    float f0;  // from the IOR
    float f90; // at grazing incidence, before the specular weight
    float ior; // of refracting bodies, at least MIN_REFRACTING_IOR
    float specular;
    float transmission;
    bool unlit, blinn_phong, double_sided, masked, blends;
    bool transmits;    // transmits part of what the dielectric layer does not reflect
    bool refracts;     // transmits into a body; else through a thin wall
    bool lets_through; // straight: blended, or a thin wall
    bool emits;
    float emitted_luminance; // including its texture's mean
    uint32_t texture_mask;   // bits of enum scene_texture_slot
    struct texture textures[SCENE_TEXTURE_SLOT_COUNT];
};

struct lights;
struct environment;

struct snapshot {
    uint32_t references; // atomic
    struct scene *scene; // copy; without node names, cameras and animations
    struct ray_scene *rays;
    struct instance *instances; // per node
    struct material *materials;
    struct lights *lights;
    struct environment *environment;
    bool all_blinn_phong;
    double origin[3];
    float diagonal_m;
    bool has_bodies; // some material refracts
    struct pinned_images images;
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
