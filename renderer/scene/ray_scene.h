// Ray casts against a scene's triangles by Embree: picking, and the reference path tracer
// of the tests.
#ifndef VOXCAST_RENDERER_SCENE_RAY_SCENE_H
#define VOXCAST_RENDERER_SCENE_RAY_SCENE_H

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

// One Embree scene per mesh, instanced by the visible nodes. The scene must outlive the result.
// Cost: building a BVH over all triangles. NULL when out of memory.
struct ray_scene *ray_scene_create(const struct scene *scene);
void ray_scene_destroy(struct ray_scene **ray_scene);

// Takes over node placement and visibility from the scene; cheap. Call after edits.
void ray_scene_update_transforms(struct ray_scene *ray_scene);

// The nearest hit along the ray within (0, max_distance), through alpha-masked holes. False and
// untouched output if there is none or an argument is not finite. Thread-safe between updates.
bool ray_scene_intersect(const struct ray_scene *ray_scene, const float origin[3],
                         const float direction[3], float max_distance, struct ray_hit *out_hit);

#endif
