#include "renderer/path_tracer/surface.h"

#include <string.h>

#include "renderer/path_tracer/bsdf.h"

// Vertex values of a triangle.
struct corners {
    const struct scene_vertex *vertices[3];
    float weights[3];
};

// Loads four floats from inside a vertex; the fourth belongs to the next field.
static float3 load_lanes(const float *values)
{
    float3 lanes;
    memcpy(&lanes, values, sizeof(lanes));
    return lanes;
}

#define INTERPOLATE(corners, field)                                                                \
    (load_lanes((corners)->vertices[0]->field) * (corners)->weights[0] +                           \
     load_lanes((corners)->vertices[1]->field) * (corners)->weights[1] +                           \
     load_lanes((corners)->vertices[2]->field) * (corners)->weights[2])

// For vectors whose squared length is out of range. False if the length is 0.
static __attribute__((noinline)) bool normalize_extreme(float3 *vector)
{
    float largest = max1(fabsf((*vector)[0]), max1(fabsf((*vector)[1]), fabsf((*vector)[2])));
    if (!(largest > 0.0f) || !isfinite(largest))
        return false;
    *vector *= 1.0f / max1(largest, 1e-38f);
    *vector *= 1.0f / sqrtf(dot3(*vector, *vector));
    return true;
}

static inline bool normalize_any(float3 *vector)
{
    float squared = dot3(*vector, *vector);
    if (!(squared > 1e-30f && squared < 1e30f))
        return normalize_extreme(vector);
    *vector *= 1.0f / sqrtf(squared);
    return true;
}

static float3 get_texture(const struct material *material, enum scene_texture_slot slot,
                          const float uv[4])
{
    if (!(material->texture_mask & 1u << slot))
        return splat3(1.0f);
    const struct texture *texture = &material->textures[slot];
    return texture_get(texture, uv + (size_t)2 * texture->uv_set);
}

// Applies the material's normal map to a unit normal (world, on the front).
static float3 mapped_normal(const struct surface *surface, const struct instance *instance,
                            const struct corners *corners, const float uv[4], float3 normal)
{
    const struct material *material = surface->material;
    float3 tangent = instance_vector(instance, INTERPOLATE(corners, tangent));
    tangent -= normal * dot3(normal, tangent);
    if (!normalize_any(&tangent))
        return normal;
    bool reversed = corners->vertices[0]->tangent[3] < 0.0f;
    float3 bitangent = cross3(normal, tangent);
    float3 texel = get_texture(material, SCENE_TEXTURE_NORMAL, uv) * 2.0f - 1.0f;
    float up = texel[1] * material->normal_scale;
    float3 mapped = tangent * (texel[0] * material->normal_scale) +
                    bitangent * (reversed != instance->mirrored ? -up : up) + normal * texel[2];
    return normalize_any(&mapped) ? mapped : normal;
}

static void fill_material(struct surface *surface, const struct corners *corners, const float uv[4])
{
    const struct material *material = surface->material;
    float3 base = material->base_color * INTERPOLATE(corners, color);
    float3 specular_color = material->specular_color;
    float weight = material->specular, transmission = material->transmission;
    surface->metallic = material->metallic;
    surface->roughness = material->roughness;
    surface->emission = material->emission;
    if (material->texture_mask) {
        float3 metallic_roughness = get_texture(material, SCENE_TEXTURE_METALLIC_ROUGHNESS, uv);
        base *= get_texture(material, SCENE_TEXTURE_BASE_COLOR, uv);
        surface->metallic *= metallic_roughness[2];
        surface->roughness *= metallic_roughness[1];
        surface->emission *= get_texture(material, SCENE_TEXTURE_EMISSIVE, uv);
        specular_color *= get_texture(material, SCENE_TEXTURE_SPECULAR_COLOR, uv);
        weight *= get_texture(material, SCENE_TEXTURE_SPECULAR, uv)[3];
        if (material->transmits)
            transmission *= get_texture(material, SCENE_TEXTURE_TRANSMISSION, uv)[0];
    }
    surface->metallic = clamp01(surface->metallic);
    surface->roughness = clamp01(surface->roughness);
    surface->alpha = base[3];
    surface->coverage = material->blends ? clamp01(base[3]) : 1.0f;
    surface->transmission = transmission * (1.0f - surface->metallic);
    surface->f90 = material->f90 * weight;
    surface->base_color = clamp013(base);
    surface->f0 = smaller3(specular_color * material->f0, splat3(1.0f)) * weight;
    if (material->unlit)
        surface->emission = surface->base_color;
    if (surface->is_back)
        surface->emission = splat3(0.0f);
}

// Texture coordinates of both sets. Prefetches the texels while the geometry is computed.
static void locate_textures(const struct material *material, const struct corners *corners,
                            float out_uv[4])
{
    float3 mean = INTERPOLATE(corners, uv[0]);
    memcpy(out_uv, &mean, 4 * sizeof(float));
    for (uint32_t slots = material->texture_mask; slots != 0; slots &= slots - 1) {
        const struct texture *texture = &material->textures[__builtin_ctz(slots)];
        texture_prefetch(texture, out_uv + (size_t)2 * texture->uv_set);
    }
}

bool surface_init(struct surface *surface, const struct snapshot *snapshot,
                  const struct ray_crossing *crossing, float3 direction)
{
    const struct instance *instance = &snapshot->instances[crossing->node];
    const uint32_t *indices = snapshot_triangle(snapshot, crossing->primitive, crossing->triangle);
    float u = crossing->barycentric[0], v = crossing->barycentric[1];
    struct corners corners = {.weights = {1.0f - u - v, u, v}};
    for (int corner = 0; corner < 3; corner++)
        corners.vertices[corner] = &snapshot->scene->vertices[indices[corner]];
    const struct material *material = snapshot_material(snapshot, crossing->primitive);
    surface->material = material;
    float uv[4] = {0};
    if (material->texture_mask)
        locate_textures(material, &corners, uv);
    float3 first = load_lanes(corners.vertices[0]->position);
    float3 edges[2] = {load_lanes(corners.vertices[1]->position) - first,
                       load_lanes(corners.vertices[2]->position) - first};
    float3 face = instance_normal(instance, cross3(edges[0], edges[1]));
    if (!normalize_any(&face))
        return false;
    float3 shading = instance_normal(instance, INTERPOLATE(&corners, normal));
    if (!normalize_any(&shading))
        shading = face;
    if (material->texture_mask & 1u << SCENE_TEXTURE_NORMAL)
        shading = mapped_normal(surface, instance, &corners, uv, shading);
    surface->is_front = dot3(face, direction) <= 0.0f;
    surface->is_back = !surface->is_front && !material->double_sided;
    surface->position = instance_point(instance, first + edges[0] * u + edges[1] * v);
    surface->span = span3(edges[0], edges[1]) * instance->stretch;
    surface->view = -direction;
    surface->geometric_normal = surface->is_front ? face : -face;
    surface->normal = surface->is_front ? shading : -shading;
    fill_material(surface, &corners, uv);
    return true;
}

float3 surface_passed(const struct surface *surface)
{
    const struct material *material = surface->material;
    if (!material->lets_through)
        return splat3(0.0f);
    float3 passed = splat3(1.0f - surface->coverage);
    if (!material->transmits || material->refracts)
        return passed;
    float n_v = clamp01(dot3(surface->normal, surface->view));
    float3 kept = splat3(1.0f) - schlick(surface->f0, splat3(surface->f90), n_v);
    return passed + surface->base_color * kept * (surface->coverage * surface->transmission);
}
