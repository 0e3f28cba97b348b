// Ray casts against a scene's triangles with Embree, for picking and the path tracer.
#ifndef VOXCAST_RENDERER_SCENE_RAY_SCENE_H
#define VOXCAST_RENDERER_SCENE_RAY_SCENE_H

#include <stddef.h>

#include "renderer/scene/scene.h"

struct ray_scene;

struct ray_hit {
    uint32_t node;
    uint32_t primitive; // in scene->primitives
    uint32_t triangle;  // in the primitive
    uint32_t material;
    float barycentric[2]; // weights of the triangle's second and third vertex
    float distance;       // in units of the direction's length
    float position[3];    // world
    float normal[3];      // world, unit, geometric, facing the ray's origin
};

// From `origin` along `direction`; all finite, the direction not zero.
struct ray {
    float origin[3];
    float direction[3];
    float max_distance; // in units of the direction's length
};

// A closest hit reduced to what a path tracer needs billions of times.
struct ray_crossing {
    uint32_t node;
    uint32_t primitive; // in scene->primitives
    uint32_t triangle;  // in the primitive
    float barycentric[2];
    float distance; // in units of the direction's length
};

// Whether a triangle blocks an occlusion query's ray (number `ray`; 0 for single rays). Called for
// materials that let light pass, in any order.
typedef bool ray_scene_stops_light(void *context, uint32_t ray,
                                   const struct ray_crossing *crossing);

// Rays to cast together, and their results.
#define RAY_BATCH_SIZE 64u
enum ray_batch_field {
    RAY_ORIGIN,
    RAY_NEAR = 3,
    RAY_DIRECTION,
    RAY_TIME = 7,
    RAY_DISTANCE,
    RAY_MASK,
    RAY_ID,
    RAY_FLAGS,
    RAY_HIT,
    RAY_BATCH_FIELDS = 20
};
struct ray_batch {
    // Packets in Embree's layout: per field as many values as a packet has rays.
    _Alignas(64) float fields[RAY_BATCH_FIELDS * RAY_BATCH_SIZE];
    uint32_t width; // rays per packet, a power of two; 1: cast one by one
    uint32_t count;
};

struct ray_scene_params {
    const struct scene *scene;
    const bool *lets_light_pass; // by material, copied; NULL: none lets light pass
    bool calling_thread_only;    // builds slowly, on the calling thread alone and at its priority
};

// One Embree scene per mesh, instanced by the visible nodes. The scene must outlive the result.
// Cost: a BVH build over all triangles. NULL when out of memory.
struct ray_scene *ray_scene_create(const struct scene *scene);
struct ray_scene *ray_scene_create_for_light(const struct ray_scene_params *params);
void ray_scene_destroy(struct ray_scene **ray_scene);

// Updates node transforms and visibility from the scene; cheap. Call after edits.
void ray_scene_update_transforms(struct ray_scene *ray_scene);

// Updates which materials are alpha-masked: cheap unless that has changed; then rebuilds the
// affected meshes. Call after edits of materials.
void ray_scene_update_materials(struct ray_scene *ray_scene);

// Closest hit within (0, max_distance); passes through alpha-masked holes. False, with the output
// unchanged, on a miss or if an argument is not finite. Thread-safe between updates.
bool ray_scene_intersect(const struct ray_scene *ray_scene, const float origin[3],
                         const float direction[3], float max_distance, struct ray_hit *out_hit);

// Empties a batch, for use with this ray_scene only. `coherent`: adjacent rays are similar; then a
// packet costs little more than one ray, and results differ by rounding at most.
void ray_batch_init(struct ray_batch *batch, const struct ray_scene *ray_scene, bool coherent);

// First field of a ray; the others follow at multiples of the width.
static inline float *ray_batch_fields(const struct ray_batch *batch, uint32_t ray)
{
    uint32_t within = ray & (batch->width - 1);
    return (float *)batch->fields + (size_t)(RAY_BATCH_FIELDS * (ray - within) + within);
}

// The batch must hold less than RAY_BATCH_SIZE.
static inline void ray_batch_add(struct ray_batch *batch, const struct ray *ray)
{
    uint32_t width = batch->width;
    float *fields = ray_batch_fields(batch, batch->count++);
    for (uint32_t axis = 0; axis < 3; axis++) {
        fields[(RAY_ORIGIN + axis) * width] = ray->origin[axis];
        fields[(RAY_DIRECTION + axis) * width] = ray->direction[axis];
    }
    fields[RAY_DISTANCE * width] = ray->max_distance;
}

// Call after ray_scene_occlude_all(). Embree marks a hit with minus infinity.
static inline bool ray_batch_is_occluded(const struct ray_batch *batch, uint32_t ray)
{
    return ray_batch_fields(batch, ray)[RAY_DISTANCE * batch->width] < 0.0f;
}

// Closest hits of all rays. For trusted rays; costs little more than Embree itself.
void ray_scene_find_all(const struct ray_scene *ray_scene, struct ray_batch *batch);

// Whether anything opaque lies along each ray; alpha-masked holes do not count. `stops_light`
// decides for materials that let light pass; NULL: they block nothing. Thread-safe between updates.
void ray_scene_occlude_all(const struct ray_scene *ray_scene, struct ray_batch *batch,
                           ray_scene_stops_light *stops_light, void *context);

// Closest hit of a ray of a batch. False on a miss.
bool ray_scene_get_crossing(const struct ray_scene *ray_scene, const struct ray_batch *batch,
                            uint32_t ray, struct ray_crossing *out_crossing);

// Rays for benchmarking Embree alone on this scene: closest hits, or occlusion.
struct ray_load {
    struct ray ray;
    bool is_shadow;
};

// Casts all of them in a bare loop that only copies each ray. Returns how many hit something.
uint64_t ray_scene_cast_all(const struct ray_scene *ray_scene, const struct ray_load *rays,
                            uint64_t count);

#endif
