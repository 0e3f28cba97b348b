#include "renderer/import/builtin/mesh_builder.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "renderer/scene/placement.h"

#define FIRST_CAPACITY 1024u

void mesh_builder_init(struct mesh_builder *builder)
{
    *builder = (struct mesh_builder){0};
    glm_mat4_identity(builder->placement);
}

void mesh_builder_finish(struct mesh_builder *builder)
{
    triangle_mesh_finish(&builder->mesh);
    mesh_builder_init(builder);
}

void mesh_builder_add_node(struct mesh_builder *builder, float x, float y, float z, float turn_rad)
{
    glm_translate_make(builder->placement, (vec3){x, y, z});
    glm_rotate_y(builder->placement, turn_rad, builder->placement);
}

bool mesh_builder_commit(struct mesh_builder *builder, struct scene *scene, uint32_t material)
{
    struct triangle_mesh *mesh = &builder->mesh;
    bool committed = !builder->failed && material != SCENE_NONE && mesh->index_count > 0 &&
                     triangle_mesh_make_tangents(mesh, 0) &&
                     scene_add_primitive(scene, mesh->vertices, mesh->vertex_count, mesh->indices,
                                         mesh->index_count, material) != SCENE_NONE;
    mesh_builder_finish(builder);
    builder->failed = !committed;
    return committed;
}

uint32_t mesh_builder_commit_mesh(struct mesh_builder *builder, struct scene *scene,
                                  const char *name, uint32_t material)
{
    uint32_t mesh = scene_add_mesh(scene, name);
    if (mesh == SCENE_NONE || !mesh_builder_commit(builder, scene, material))
        return SCENE_NONE;
    return mesh;
}

// Reserves one more element; doubles the capacity. False, and sets `failed`, when memory runs out.
static bool reserve(struct mesh_builder *builder, void **items, uint32_t *capacity, uint32_t count,
                    size_t item_size)
{
    if (builder->failed)
        return false;
    if (count < *capacity)
        return true;
    uint32_t wanted = *capacity ? *capacity * 2 : FIRST_CAPACITY;
    void *grown = realloc(*items, (size_t)wanted * item_size);
    if (!grown) {
        builder->failed = true;
        return false;
    }
    *items = grown;
    *capacity = wanted;
    return true;
}

uint32_t mesh_builder_add_vertex(struct mesh_builder *builder, const float position[3],
                                 const float normal[3], float u, float v)
{
    struct triangle_mesh *mesh = &builder->mesh;
    if (!reserve(builder, (void **)&mesh->vertices, &builder->vertex_capacity, mesh->vertex_count,
                 sizeof(*mesh->vertices)))
        return 0;
    struct scene_vertex *vertex = &mesh->vertices[mesh->vertex_count];
    *vertex = (struct scene_vertex){.color = {1.0f, 1.0f, 1.0f, 1.0f}};
    vec3 turned;
    glm_mat4_mulv3(builder->placement, (float *)position, 1.0f, vertex->position);
    glm_mat4_mulv3(builder->placement, (float *)normal, 0.0f, turned);
    placement_normalize_or(turned, (float[3]){0.0f, 1.0f, 0.0f}, vertex->normal);
    vertex->uv[0][0] = vertex->uv[1][0] = u;
    vertex->uv[0][1] = vertex->uv[1][1] = v;
    return mesh->vertex_count++;
}

static bool same_position(const struct triangle_mesh *mesh, uint32_t a, uint32_t b)
{
    return glm_vec3_distance2(mesh->vertices[a].position, mesh->vertices[b].position) < 1e-14f;
}

void mesh_builder_add_triangle(struct mesh_builder *builder, uint32_t a, uint32_t b, uint32_t c)
{
    struct triangle_mesh *mesh = &builder->mesh;
    if (builder->failed || same_position(mesh, a, b) || same_position(mesh, b, c) ||
        same_position(mesh, c, a))
        return;
    const uint32_t corners[3] = {a, b, c};
    for (int i = 0; i < 3; i++) {
        if (!reserve(builder, (void **)&mesh->indices, &builder->index_capacity, mesh->index_count,
                     sizeof(*mesh->indices)))
            return;
        mesh->indices[mesh->index_count++] = corners[i];
    }
    if (builder->failed)
        mesh->index_count -= mesh->index_count % 3;
}

void mesh_builder_add_quad(struct mesh_builder *builder, const float corners[4][3])
{
    vec3 diagonal, other, normal;
    glm_vec3_sub((float *)corners[2], (float *)corners[0], diagonal);
    glm_vec3_sub((float *)corners[3], (float *)corners[1], other);
    glm_vec3_cross(diagonal, other, normal);
    float facing[3] = {fabsf(normal[0]), fabsf(normal[1]), fabsf(normal[2])};
    uint32_t vertices[4];
    for (int i = 0; i < 4; i++) {
        const float *p = corners[i];
        float u, v;
        if (facing[1] > 1.001f * fmaxf(facing[0], facing[2])) {
            u = p[0];
            v = p[2];
        } else {
            u = facing[0] > facing[2] ? p[2] : p[0];
            v = -p[1];
        }
        vertices[i] = mesh_builder_add_vertex(builder, p, normal, u, v);
    }
    mesh_builder_add_triangle(builder, vertices[0], vertices[1], vertices[2]);
    mesh_builder_add_triangle(builder, vertices[0], vertices[2], vertices[3]);
}

// Corner k of a box's face: counter-clockwise seen from outside.
static void face_corner(const float low[3], const float high[3], int axis, bool positive, int k,
                        float out_corner[3])
{
    static const int around[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    const int *side = around[positive ? k : 3 - k];
    int first = (axis + 1) % 3, second = (axis + 2) % 3;
    out_corner[axis] = positive ? high[axis] : low[axis];
    out_corner[first] = side[0] ? high[first] : low[first];
    out_corner[second] = side[1] ? high[second] : low[second];
}

void mesh_builder_add_box(struct mesh_builder *builder, const float low[3], const float high[3],
                          unsigned faces)
{
    for (int face = 0; face < 6; face++) {
        if (!(faces & 1u << face))
            continue;
        float corners[4][3];
        for (int k = 0; k < 4; k++)
            face_corner(low, high, face / 2, face & 1, k, corners[k]);
        mesh_builder_add_quad(builder, corners);
    }
}

// The box's corner (bit 0: high x, ...) moved inwards along two axes, so that it lies on the face
// towards `axis`.
static void inset_corner(const float low[3], const float high[3], float bevel, int corner, int axis,
                         float out[3])
{
    for (int i = 0; i < 3; i++) {
        bool upper = corner >> i & 1;
        out[i] = upper ? high[i] : low[i];
        if (i != axis)
            out[i] += upper ? -bevel : bevel;
    }
}

void mesh_builder_add_beveled_box(struct mesh_builder *builder, const float low[3],
                                  const float high[3], float bevel_m)
{
    for (int axis = 0; axis < 3; axis++) {
        int first = (axis + 1) % 3, second = (axis + 2) % 3;
        for (int side = 0; side < 2; side++) {
            float corners[4][3], inner_low[3], inner_high[3];
            memcpy(inner_low, low, sizeof(inner_low));
            memcpy(inner_high, high, sizeof(inner_high));
            inner_low[first] += bevel_m, inner_low[second] += bevel_m;
            inner_high[first] -= bevel_m, inner_high[second] -= bevel_m;
            for (int k = 0; k < 4; k++)
                face_corner(inner_low, inner_high, axis, side, k, corners[k]);
            mesh_builder_add_quad(builder, corners);
        }
        // The four bevelled edges along this axis lie between the faces of the other two.
        for (int edge = 0; edge < 4; edge++) {
            int corner = (edge & 1) << first | (edge >> 1) << second;
            float corners[4][3];
            inset_corner(low, high, bevel_m, corner, first, corners[0]);
            inset_corner(low, high, bevel_m, corner, second, corners[1]);
            inset_corner(low, high, bevel_m, corner | 1 << axis, second, corners[2]);
            inset_corner(low, high, bevel_m, corner | 1 << axis, first, corners[3]);
            if ((edge & 1) != edge >> 1) {
                vec3 kept;
                memcpy(kept, corners[1], sizeof(kept));
                memcpy(corners[1], corners[3], sizeof(kept));
                memcpy(corners[3], kept, sizeof(kept));
            }
            mesh_builder_add_quad(builder, corners);
        }
    }
    for (int corner = 0; corner < 8; corner++) {
        float points[3][3];
        vec3 normal;
        for (int axis = 0; axis < 3; axis++) {
            inset_corner(low, high, bevel_m, corner, axis, points[axis]);
            normal[axis] = corner >> axis & 1 ? 1.0f : -1.0f;
        }
        uint32_t vertices[3];
        for (int i = 0; i < 3; i++)
            vertices[i] =
                mesh_builder_add_vertex(builder, points[i], normal, points[i][0], -points[i][1]);
        bool outward = normal[0] * normal[1] * normal[2] > 0.0f;
        mesh_builder_add_triangle(builder, vertices[0], vertices[outward ? 1 : 2],
                                  vertices[outward ? 2 : 1]);
    }
}

static void difference_normal(const struct surface_params *params, double u, double v,
                              double out_normal[3])
{
    const double step = 1e-4;
    double from[3], to[3], along[2][3];
    // Poles have no normal: uses that of a point nearby.
    u = fmin(fmax(u, 2.0 * step), 1.0 - 2.0 * step);
    v = fmin(fmax(v, 2.0 * step), 1.0 - 2.0 * step);
    for (int i = 0; i < 2; i++) {
        params->position(params->context, u - (i ? 0.0 : step), v - (i ? step : 0.0), from);
        params->position(params->context, u + (i ? 0.0 : step), v + (i ? step : 0.0), to);
        for (int axis = 0; axis < 3; axis++)
            along[i][axis] = to[axis] - from[axis];
    }
    for (int axis = 0; axis < 3; axis++) {
        int next = (axis + 1) % 3, last = (axis + 2) % 3;
        out_normal[axis] = along[0][next] * along[1][last] - along[0][last] * along[1][next];
    }
    double length = sqrt(out_normal[0] * out_normal[0] + out_normal[1] * out_normal[1] +
                         out_normal[2] * out_normal[2]);
    for (int axis = 0; axis < 3 && length > 0.0; axis++)
        out_normal[axis] /= length;
}

void mesh_builder_add_surface(struct mesh_builder *builder, const struct surface_params *params)
{
    uint32_t first = builder->mesh.vertex_count;
    float side = params->flipped ? -1.0f : 1.0f;
    for (uint32_t row = 0; row <= params->rows; row++) {
        for (uint32_t column = 0; column <= params->columns; column++) {
            double u = (double)column / params->columns, v = (double)row / params->rows;
            double position[3], normal[3];
            params->position(params->context, u, v, position);
            if (params->normal)
                params->normal(params->context, u, v, normal);
            else
                difference_normal(params, u, v, normal);
            mesh_builder_add_vertex(
                builder, (float[3]){(float)position[0], (float)position[1], (float)position[2]},
                (float[3]){side * (float)normal[0], side * (float)normal[1],
                           side * (float)normal[2]},
                (float)u * params->texture_size[0], (float)v * params->texture_size[1]);
        }
    }
    uint32_t stride = params->columns + 1;
    for (uint32_t row = 0; row < params->rows; row++) {
        for (uint32_t column = 0; column < params->columns; column++) {
            uint32_t a = first + row * stride + column, b = a + 1, c = b + stride, d = a + stride;
            mesh_builder_add_triangle(builder, a, params->flipped ? c : b, params->flipped ? b : c);
            mesh_builder_add_triangle(builder, a, params->flipped ? d : c, params->flipped ? c : d);
        }
    }
}
