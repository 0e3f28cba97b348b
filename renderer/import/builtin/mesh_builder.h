// Builds triangle lists for the built-in scenes from a small set of shapes, with normals, texture
// coordinates in metres and counter-clockwise fronts.
//
// A builder collects shapes, each under the current transform, until mesh_builder_commit() turns
// them into one primitive. An allocation failure is remembered and makes the commit fail; nothing
// else needs checking.
#ifndef VOXCAST_RENDERER_IMPORT_BUILTIN_MESH_BUILDER_H
#define VOXCAST_RENDERER_IMPORT_BUILTIN_MESH_BUILDER_H

#include <cglm/cglm.h>

#include "renderer/scene/scene.h"
#include "renderer/scene/triangle_mesh.h"

struct mesh_builder {
    struct triangle_mesh mesh; // owned
    uint32_t vertex_capacity, index_capacity;
    mat4 placement; // rotation, translation and uniform scale of shapes added next
    bool failed;    // out of memory
};

void mesh_builder_init(struct mesh_builder *builder);
void mesh_builder_finish(struct mesh_builder *builder);

// Transform of shapes added next: rotated about +Y, then translated.
void mesh_builder_add_node(struct mesh_builder *builder, float x, float y, float z, float turn_rad);

// Computes tangents from texture coordinates, appends everything collected as one primitive to the
// scene's newest mesh and empties the builder. False when memory ran out now or before.
bool mesh_builder_commit(struct mesh_builder *builder, struct scene *scene, uint32_t material);

// A mesh with one primitive from everything collected. SCENE_NONE when memory ran out.
uint32_t mesh_builder_commit_mesh(struct mesh_builder *builder, struct scene *scene,
                                  const char *name, uint32_t material);

// Returns the vertex's index. `normal` need not be unit length.
uint32_t mesh_builder_add_vertex(struct mesh_builder *builder, const float position[3],
                                 const float normal[3], float u, float v);

// Skips triangles with two equal corners, as at the poles of a sphere.
void mesh_builder_add_triangle(struct mesh_builder *builder, uint32_t a, uint32_t b, uint32_t c);

// A flat quad, corners counter-clockwise seen from the front. Texture coordinates are metres in the
// plane of the two axes most parallel to the quad, so that adjacent quads match.
void mesh_builder_add_quad(struct mesh_builder *builder, const float corners[4][3]);

enum box_face {
    BOX_LEFT = 1, // -X
    BOX_RIGHT = 2,
    BOX_BOTTOM = 4, // -Y
    BOX_TOP = 8,
    BOX_BACK = 16, // -Z
    BOX_FRONT = 32,
    BOX_ALL = 63,
};

// A box, or only its visible faces (enum box_face).
void mesh_builder_add_box(struct mesh_builder *builder, const float low[3], const float high[3],
                          unsigned faces);

// A box with its twelve edges bevelled at 45 degrees, `bevel_m` wide.
void mesh_builder_add_beveled_box(struct mesh_builder *builder, const float low[3],
                                  const float high[3], float bevel_m);

// A point of a smooth surface. u and v run over 0..1; dP/du x dP/dv must point to the front.
typedef void (*surface_function)(const void *context, double u, double v, double out_position[3]);

struct surface_params {
    surface_function position;
    surface_function normal; // NULL: by differences of `position`
    const void *context;
    uint32_t columns, rows; // quads along u and v
    float texture_size[2];  // extent of u and v in metres (or repeats)
    bool flipped;           // swaps front and back
};

// A grid of quads over a smooth surface. Poles, where an edge collapses to a point, are allowed.
void mesh_builder_add_surface(struct mesh_builder *builder, const struct surface_params *params);

// A point of an outline: `out` is the distance from the axis or path, `up` the height.
struct profile_point {
    float out, up;
    bool smooth; // no hard edge here
};

// Revolves an outline about +Y. The outline runs upwards with its front on the outer side. Skips
// segments of zero length and those on the axis.
void mesh_builder_add_lathe(struct mesh_builder *builder, const struct profile_point *profile,
                            uint32_t count, uint32_t segments);

// An upright shaft with `flutes` grooves of `depth_m`, tapering from one radius to another.
void mesh_builder_add_fluted_shaft(struct mesh_builder *builder, const float radius_m[2],
                                   const float height_m[2], uint32_t flutes, float depth_m);

// Sweeps an outline around the rectangle +-half_x, +-half_z with mitred corners. `out` points away
// from the rectangle's centre. The outline's front is on its right, seen along it with `out` to the
// right and `up` upwards.
void mesh_builder_add_loop(struct mesh_builder *builder, const float half_extent[2],
                           const struct profile_point *profile, uint32_t count);

// A closed torus about +Y in the plane y = 0.
void mesh_builder_add_torus(struct mesh_builder *builder, float ring_radius_m, float tube_radius_m,
                            uint32_t ring_segments, uint32_t tube_segments);

// A sphere about `center`.
void mesh_builder_add_sphere(struct mesh_builder *builder, const float center[3], float radius_m,
                             uint32_t segments, uint32_t rings);

// A round rod between two points, without caps.
void mesh_builder_add_rod(struct mesh_builder *builder, const float from[3], const float to[3],
                          float radius_m, uint32_t segments);

// A wall along X with a semicircular (or elliptic) opening at its foot, centred on the origin:
// front and back faces and the underside of the arch. y = 0 is the springing line.
struct arch_params {
    float width_m, thickness_m, top_m;
    float radius_m[2]; // of the opening: along X and up
    uint32_t segments; // an even number
};
void mesh_builder_add_arch_wall(struct mesh_builder *builder, const struct arch_params *params);

// A band along the arch between two ellipses: both faces, the inner and the outer side.
void mesh_builder_add_arch_band(struct mesh_builder *builder, const float inner_m[2],
                                const float outer_m[2], float thickness_m, uint32_t segments);

#endif
