#include "renderer/reference/path_surface.h"

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
    double tangent[3];
    bool reversed; // the bitangent
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
        for (int axis = 0; axis < 3; axis++) {
            out_mean->normal[axis] += weights[corner] * vertex->normal[axis];
            out_mean->tangent[axis] += weights[corner] * vertex->tangent[axis];
        }
        out_mean->reversed = vertex->tangent[3] < 0.0f;
        for (int i = 0; i < 4; i++)
            out_mean->uv[i / 2][i % 2] += weights[corner] * vertex->uv[i / 2][i % 2];
        for (int c = 0; c < 4; c++)
            out_mean->color[c] += weights[corner] * vertex->color[c];
    }
}

// The dielectric layer: IOR 1 has none, 0 reflects everything (KHR_materials_ior).
static void fill_dielectric(struct path_surface *surface, const struct scene *scene,
                            const struct scene_material *material, const struct vertex_mean *mean)
{
    double weight[4], color[4];
    sample_slot(scene, material, SCENE_TEXTURE_SPECULAR, mean->uv, weight);
    sample_slot(scene, material, SCENE_TEXTURE_SPECULAR_COLOR, mean->uv, color);
    double ratio = material->ior > 0.0f ? (material->ior - 1.0) / (material->ior + 1.0) : 1.0;
    double strength = material->specular * weight[3];
    for (int c = 0; c < 3; c++)
        surface->f0[c] =
            fmin(ratio * ratio * material->specular_color[c] * color[c], 1.0) * strength;
    surface->f90 = material->ior == 1.0f ? 0.0 : strength;
}

// Coverage (alphaMode BLEND) and transmission let light pass, as the rasteriser's layers do.
static void fill_passing(struct path_surface *surface, const struct scene *scene,
                         const struct scene_material *material, const struct vertex_mean *mean,
                         double alpha)
{
    double transmission[4];
    sample_slot(scene, material, SCENE_TEXTURE_TRANSMISSION, mean->uv, transmission);
    double through = material->transmission * transmission[0] * (1.0 - surface->metallic);
    double coverage = material->alpha_mode == SCENE_ALPHA_BLEND ? alpha : 1.0;
    surface->passed = 1.0 - coverage * (1.0 - through);
    double untinted = surface->passed > 0.0 ? (1.0 - coverage) / surface->passed : 0.0;
    for (int c = 0; c < 3; c++)
        surface->passed_tint[c] = untinted + (1.0 - untinted) * surface->base_color[c];
}

static void fill_material(struct path_surface *surface, const struct scene *scene,
                          const struct vertex_mean *mean)
{
    const struct scene_material *material = &scene->materials[surface->material];
    double base[4], emissive[4], metallic_roughness[4];
    sample_slot(scene, material, SCENE_TEXTURE_BASE_COLOR, mean->uv, base);
    sample_slot(scene, material, SCENE_TEXTURE_EMISSIVE, mean->uv, emissive);
    sample_slot(scene, material, SCENE_TEXTURE_METALLIC_ROUGHNESS, mean->uv, metallic_roughness);
    for (int c = 0; c < 4; c++)
        base[c] = fmin(fmax(base[c] * material->base_color[c] * mean->color[c], 0.0), 1.0);
    surface->unlit = material->shading == SCENE_SHADING_UNLIT;
    surface->metallic = fmin(fmax(material->metallic * metallic_roughness[2], 0.0), 1.0);
    surface->roughness = fmin(fmax(material->roughness * metallic_roughness[1], 0.0), 1.0);
    for (int c = 0; c < 3; c++) {
        double glow = (double)material->emissive[c] * material->emissive_strength * emissive[c];
        surface->base_color[c] = base[c];
        surface->emission[c] = surface->unlit ? base[c] : glow;
        if (surface->is_back)
            surface->emission[c] = 0.0;
    }
    fill_dielectric(surface, scene, material, mean);
    fill_passing(surface, scene, material, mean, base[3]);
}

static bool normalize(double vector[3])
{
    double length = vector3_length(vector);
    for (int axis = 0; axis < 3 && length > 0.0; axis++)
        vector[axis] /= length;
    return length > 0.0;
}

// Turns a unit normal (world, on the front) by the material's normal map.
static void apply_normal_map(const struct scene *scene, const struct ray_hit *hit,
                             const struct vertex_mean *mean, double normal[3])
{
    const struct scene_material *material = &scene->materials[hit->material];
    if (material->textures[SCENE_TEXTURE_NORMAL].image == SCENE_NONE)
        return;
    const float *m = scene->nodes[hit->node].world_from_local;
    double columns[3][3], tangent[3], bitangent[3], across[3], texel[4];
    for (int i = 0; i < 9; i++)
        columns[i / 3][i % 3] = m[4 * (i / 3) + i % 3];
    for (int row = 0; row < 3; row++) {
        tangent[row] = 0.0;
        for (int column = 0; column < 3; column++)
            tangent[row] += columns[column][row] * mean->tangent[column];
    }
    double along = vector3_dot(normal, tangent);
    for (int axis = 0; axis < 3; axis++)
        tangent[axis] -= along * normal[axis];
    if (!normalize(tangent))
        return;
    vector3_cross(bitangent, normal, tangent);
    vector3_cross(across, columns[0], columns[1]);
    bool mirrored = vector3_dot(across, columns[2]) < 0.0;
    sample_slot(scene, material, SCENE_TEXTURE_NORMAL, mean->uv, texel);
    double x = (2.0 * texel[0] - 1.0) * material->normal_scale;
    double y = (2.0 * texel[1] - 1.0) * material->normal_scale;
    double turn = mean->reversed != mirrored ? -y : y, z = 2.0 * texel[2] - 1.0;
    double mapped[3];
    for (int axis = 0; axis < 3; axis++)
        mapped[axis] = tangent[axis] * x + bitangent[axis] * turn + normal[axis] * z;
    if (normalize(mapped))
        memcpy(normal, mapped, sizeof(mapped));
}

bool path_surface_init(struct path_surface *surface, const struct scene *scene,
                       const struct ray_hit *hit, const double direction[3])
{
    double corners[3][3], face[3], shading[3];
    path_triangle_corners(scene, hit, corners, face);
    if (!normalize(face))
        return false;
    struct vertex_mean mean;
    interpolate(scene, hit, &mean);
    transform_normal(scene->nodes[hit->node].world_from_local, mean.normal, shading);
    if (!normalize(shading))
        memcpy(shading, face, sizeof(shading));
    apply_normal_map(scene, hit, &mean, shading);
    bool reversed = vector3_dot(face, direction) > 0.0;
    double sign = reversed ? -1.0 : 1.0;
    surface->material = hit->material;
    surface->is_back = reversed && !scene->materials[hit->material].double_sided;
    const double weights[3] = {1.0 - hit->barycentric[0] - hit->barycentric[1], hit->barycentric[0],
                               hit->barycentric[1]};
    for (int axis = 0; axis < 3; axis++) {
        surface->view[axis] = -direction[axis];
        surface->position[axis] = 0.0;
        for (int corner = 0; corner < 3; corner++)
            surface->position[axis] += weights[corner] * corners[corner][axis];
        surface->geometric_normal[axis] = sign * face[axis];
        surface->normal[axis] = sign * shading[axis];
    }
    fill_material(surface, scene, &mean);
    return true;
}
