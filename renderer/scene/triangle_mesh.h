// A triangle list under construction: completes attributes that a file lacks before it is added to
// the scene.
#ifndef VOXCAST_RENDERER_SCENE_TRIANGLE_MESH_H
#define VOXCAST_RENDERER_SCENE_TRIANGLE_MESH_H

#include "renderer/scene/scene.h"

// Owns both arrays (from malloc). Indices are below vertex_count; index_count is a multiple of 3.
struct triangle_mesh {
    struct scene_vertex *vertices;
    uint32_t vertex_count;
    uint32_t *indices;
    uint32_t index_count;
};

// Frees the arrays and empties the mesh.
void triangle_mesh_finish(struct triangle_mesh *mesh);

// Gives every triangle three vertices of its own with the triangle's normal. False when out of
// memory; the mesh is then unchanged.
bool triangle_mesh_make_flat_normals(struct triangle_mesh *mesh);

// Normalises the normals. Those that are zero or not finite become the area-weighted mean of the
// adjacent triangles' normals, or +Y if there is none. Returns how many were replaced.
uint32_t triangle_mesh_repair_normals(struct triangle_mesh *mesh);

// Sets any unit tangents perpendicular to the normals: for materials without a normal map, where
// they only must be finite.
void triangle_mesh_set_any_tangents(struct triangle_mesh *mesh);

// Makes given tangents unit length and perpendicular to the normal, and their w -1 or +1.
void triangle_mesh_repair_tangents(struct triangle_mesh *mesh);

// Tangents along +U of `uv_set`, for normal maps whose green points up the image (to smaller V).
// After M. Mikkelsen, "Simulation of Wrinkled Surfaces Revisited" (2008): triangles that share
// edges of equal position, normal and UV around a vertex, and have the same winding in UV, form a
// group, whose tangent is the angle-weighted mean in the plane of the normal. Splits vertices that
// belong to several groups. Normals must be unit length. O(n log n) in the triangles. False when
// out of memory; the mesh is then unchanged.
bool triangle_mesh_make_tangents(struct triangle_mesh *mesh, uint32_t uv_set);

#endif
