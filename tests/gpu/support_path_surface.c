#include "support_path_surface.h"

#include <string.h>

#include "renderer/scene/texture_sample.h"
#include "renderer/scene/vector3.h"

static const uint32_t *triangle_indices(const struct scene *scene, const struct ray_hit *hit)
{
    return scene->indices + scene->primitives[hit->primitive].index_first +
           (size_t)hit->triangle * 3;
}

static void transform_point(const float m[16], const float point[3], double out_world[3])
{
    for (int row = 0; row < 3; row++)
        out_world[row] = (double)m[row] * point[0] + (double)m[4 + row] * point[1] +
                         (double)m[8 + row] * point[2] + m[12 + row];
}

// Normals turn by the cofactors of the placement, which point as the inverse transposed does but
// for mirrored placements.
static void transform_normal(const float m[16], const double local[3], double out_world[3])
{
    double columns[3][3], cofactors[3][3];
    for (int column = 0; column < 3; column++)
        for (int row = 0; row < 3; row++)
            columns[column][row] = m[4 * column + row];
    for (int axis = 0; axis < 3; axis++)
        vector3_cross(cofactors[axis], columns[(axis + 1) % 3], columns[(axis + 2) % 3]);
    bool mirrored = vector3_dot(cofactors[0], columns[0]) < 0.0;
    for (int row = 0; row < 3; row++) {
        out_world[row] = 0.0;
        for (int axis = 0; axis < 3; axis++)
            out_world[row] += cofactors[axis][row] * local[axis] * (mirrored ? -1.0 : 1.0);
    }
}

void path_triangle_corners(const struct scene *scene, const struct ray_hit *hit,
                           double out_corners[3][3], double out_area_normal[3])
{
    const uint32_t *indices = triangle_indices(scene, hit);
    const float *matrix = scene->nodes[hit->node].world_from_local;
    double local[3][3], edges[2][3], normal[3];
    for (int corner = 0; corner < 3; corner++) {
        transform_point(matrix, scene->vertices[indices[corner]].position, out_corners[corner]);
        for (int axis = 0; axis < 3; axis++)
            local[corner][axis] = scene->vertices[indices[corner]].position[axis];
    }
    for (int i = 0; i < 2; i++)
        vector3_subtract(edges[i], local[i + 1], local[0]);
    vector3_cross(normal, edges[0], edges[1]);
    transform_normal(matrix, normal, out_area_normal);
}

static double from_srgb(double value)
{
    return value <= 0.04045 ? value / 12.92 : pow((value + 0.055) / 1.055, 2.4);
}

static void sample_slot(const struct scene *scene, const struct scene_material *material,
                        enum scene_texture_slot slot, const double uv[2][2], double out_rgba[4])
{
    const struct scene_texture *texture = &material->textures[slot];
    const float at[2] = {(float)uv[texture->uv_set][0], (float)uv[texture->uv_set][1]};
    float texel[4];
    texture_sample(scene, texture, at, texel);
    bool is_color = slot == SCENE_TEXTURE_BASE_COLOR || slot == SCENE_TEXTURE_EMISSIVE;
    for (int c = 0; c < 4; c++)
        out_rgba[c] = is_color && c < 3 ? from_srgb(texel[c]) : texel[c];
}

struct vertex_mean {
    double normal[3];
    double uv[2][2];
    double color[4];
};

static void interpolate(const struct scene *scene, const struct ray_hit *hit,
                        struct vertex_mean *out_mean)
{
    const uint32_t *indices = triangle_indices(scene, hit);
    const double weights[3] = {1.0 - hit->barycentric[0] - hit->barycentric[1], hit->barycentric[0],
                               hit->barycentric[1]};
    *out_mean = (struct vertex_mean){0};
    for (int corner = 0; corner < 3; corner++) {
        const struct scene_vertex *vertex = &scene->vertices[indices[corner]];
        for (int axis = 0; axis < 3; axis++)
            out_mean->normal[axis] += weights[corner] * vertex->normal[axis];
        for (int i = 0; i < 4; i++)
            out_mean->uv[i / 2][i % 2] += weights[corner] * vertex->uv[i / 2][i % 2];
        for (int c = 0; c < 4; c++)
            out_mean->color[c] += weights[corner] * vertex->color[c];
    }
}

// Coverage (alphaMode BLEND) and transmission let light pass, as the rasteriser's layers do.
static void fill_material(struct path_surface *surface, const struct scene *scene,
                          const struct vertex_mean *mean)
{
    const struct scene_material *material = &scene->materials[surface->material];
    double base[4], emissive[4], metallic_roughness[4], transmission[4];
    sample_slot(scene, material, SCENE_TEXTURE_BASE_COLOR, mean->uv, base);
    sample_slot(scene, material, SCENE_TEXTURE_EMISSIVE, mean->uv, emissive);
    sample_slot(scene, material, SCENE_TEXTURE_METALLIC_ROUGHNESS, mean->uv, metallic_roughness);
    sample_slot(scene, material, SCENE_TEXTURE_TRANSMISSION, mean->uv, transmission);
    for (int c = 0; c < 4; c++)
        base[c] = fmin(fmax(base[c] * material->base_color[c] * mean->color[c], 0.0), 1.0);
    double metallic = material->metallic * metallic_roughness[2];
    double through = material->transmission * transmission[0] * (1.0 - metallic);
    double coverage = material->alpha_mode == SCENE_ALPHA_BLEND ? base[3] : 1.0;
    surface->unlit = material->shading == SCENE_SHADING_UNLIT;
    surface->passed = 1.0 - coverage * (1.0 - through);
    for (int c = 0; c < 3; c++) {
        surface->reflectance[c] = base[c] * (1.0 - metallic);
        surface->emission[c] =
            surface->is_back ? 0.0
            : surface->unlit ? base[c]
                             : material->emissive[c] * material->emissive_strength * emissive[c];
        double share = surface->passed > 0.0 ? (1.0 - coverage) / surface->passed : 0.0;
        surface->passed_tint[c] = share + (1.0 - share) * base[c];
    }
}

bool path_surface_init(struct path_surface *surface, const struct scene *scene,
                       const struct ray_hit *hit, const double direction[3])
{
    double corners[3][3], face[3];
    path_triangle_corners(scene, hit, corners, face);
    double length = vector3_length(face);
    if (!(length > 0.0))
        return false;
    struct vertex_mean mean;
    interpolate(scene, hit, &mean);
    bool reversed = vector3_dot(face, direction) > 0.0;
    double sign = reversed ? -1.0 : 1.0;
    surface->material = hit->material;
    surface->is_back = reversed && !scene->materials[hit->material].double_sided;
    const double weights[3] = {1.0 - hit->barycentric[0] - hit->barycentric[1], hit->barycentric[0],
                               hit->barycentric[1]};
    double shading[3];
    transform_normal(scene->nodes[hit->node].world_from_local, mean.normal, shading);
    double shading_length = vector3_length(shading);
    for (int axis = 0; axis < 3; axis++) {
        surface->position[axis] = 0.0;
        for (int corner = 0; corner < 3; corner++)
            surface->position[axis] += weights[corner] * corners[corner][axis];
        surface->geometric_normal[axis] = sign * face[axis] / length;
        surface->normal[axis] = shading_length > 0.0 ? sign * shading[axis] / shading_length
                                                     : surface->geometric_normal[axis];
    }
    fill_material(surface, scene, &mean);
    return true;
}
