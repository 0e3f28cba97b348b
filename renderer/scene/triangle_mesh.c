#include "renderer/scene/triangle_mesh.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "renderer/scene/vector3.h"

void triangle_mesh_finish(struct triangle_mesh *mesh)
{
    free(mesh->vertices);
    free(mesh->indices);
    *mesh = (struct triangle_mesh){0};
}

// Twice the area times the unit normal, in double, so that tiny and huge triangles keep a
// direction.
static void triangle_area_normal(const struct triangle_mesh *mesh, uint32_t first, double out[3])
{
    double corners[3][3], edge1[3], edge2[3];
    for (int corner = 0; corner < 3; corner++) {
        const float *position = mesh->vertices[mesh->indices[first + corner]].position;
        for (int axis = 0; axis < 3; axis++) {
            corners[corner][axis] = position[axis];
        }
    }
    vector3_subtract(edge1, corners[1], corners[0]);
    vector3_subtract(edge2, corners[2], corners[0]);
    vector3_cross(out, edge1, edge2);
}

static bool set_unit(float out[3], const double vector[3])
{
    double length = vector3_length(vector);
    if (!isfinite(length) || length <= 0) {
        return false;
    }
    for (int axis = 0; axis < 3; axis++) {
        out[axis] = (float)(vector[axis] / length);
    }
    return true;
}

bool triangle_mesh_make_flat_normals(struct triangle_mesh *mesh)
{
    struct scene_vertex *vertices = malloc((size_t)mesh->index_count * sizeof(*vertices) + 1);
    if (!vertices) {
        return false;
    }
    for (uint32_t first = 0; first < mesh->index_count; first += 3) {
        double area_normal[3];
        float normal[3] = {0, 1, 0}; // for a triangle without area
        triangle_area_normal(mesh, first, area_normal);
        set_unit(normal, area_normal);
        for (uint32_t i = first; i < first + 3; i++) {
            vertices[i] = mesh->vertices[mesh->indices[i]];
            memcpy(vertices[i].normal, normal, sizeof(normal));
        }
    }
    for (uint32_t i = 0; i < mesh->index_count; i++) {
        mesh->indices[i] = i;
    }
    free(mesh->vertices);
    mesh->vertices = vertices;
    mesh->vertex_count = mesh->index_count;
    return true;
}

// Computes zero normals from the adjacent triangles.
static void collect_missing_normals(struct triangle_mesh *mesh, double (*sums)[3])
{
    for (uint32_t first = 0; first < mesh->index_count; first += 3) {
        double area_normal[3];
        triangle_area_normal(mesh, first, area_normal);
        for (uint32_t i = first; i < first + 3; i++) {
            for (int axis = 0; axis < 3; axis++) {
                sums[mesh->indices[i]][axis] += area_normal[axis];
            }
        }
    }
    for (uint32_t i = 0; i < mesh->vertex_count; i++) {
        float *normal = mesh->vertices[i].normal;
        if (normal[0] == 0 && normal[1] == 0 && normal[2] == 0) {
            set_unit(normal, sums[i]);
        }
    }
}

uint32_t triangle_mesh_repair_normals(struct triangle_mesh *mesh)
{
    uint32_t bad = 0;
    for (uint32_t i = 0; i < mesh->vertex_count; i++) {
        float *normal = mesh->vertices[i].normal;
        double vector[3] = {normal[0], normal[1], normal[2]};
        if (!set_unit(normal, vector)) {
            memset(normal, 0, 3 * sizeof(float));
            bad++;
        }
    }
    if (bad == 0) {
        return 0;
    }
    double(*sums)[3] = calloc(mesh->vertex_count, sizeof(*sums));
    if (sums) {
        collect_missing_normals(mesh, sums);
        free(sums);
    }
    for (uint32_t i = 0; i < mesh->vertex_count; i++) {
        float *normal = mesh->vertices[i].normal;
        if (normal[0] == 0 && normal[1] == 0 && normal[2] == 0) {
            normal[1] = 1; // no triangle has area, or no memory to look for one
        }
    }
    return bad;
}

static void set_any_tangent(struct scene_vertex *vertex)
{
    const float *n = vertex->normal;
    double axis[3] = {fabsf(n[0]) < 0.7f ? 1 : 0, fabsf(n[0]) < 0.7f ? 0 : 1, 0};
    double along = axis[0] * n[0] + axis[1] * n[1];
    double plane[3] = {axis[0] - along * n[0], axis[1] - along * n[1], -along * n[2]};
    set_unit(vertex->tangent, plane);
    vertex->tangent[3] = 1;
}

void triangle_mesh_set_any_tangents(struct triangle_mesh *mesh)
{
    for (uint32_t i = 0; i < mesh->vertex_count; i++) {
        set_any_tangent(&mesh->vertices[i]);
    }
}

void triangle_mesh_repair_tangents(struct triangle_mesh *mesh)
{
    for (uint32_t i = 0; i < mesh->vertex_count; i++) {
        struct scene_vertex *vertex = &mesh->vertices[i];
        const float *n = vertex->normal;
        double tangent[3] = {vertex->tangent[0], vertex->tangent[1], vertex->tangent[2]};
        double along = tangent[0] * n[0] + tangent[1] * n[1] + tangent[2] * n[2];
        for (int axis = 0; axis < 3; axis++) {
            tangent[axis] -= along * n[axis];
        }
        float sign = vertex->tangent[3] < 0 ? -1.0f : 1.0f;
        if (!set_unit(vertex->tangent, tangent)) {
            set_any_tangent(vertex);
        }
        vertex->tangent[3] = sign;
    }
}
