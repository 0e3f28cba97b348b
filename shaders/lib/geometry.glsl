// Visibility id to surface: fetches the triangle, intersects the pixel's ray with it, interpolates
// attributes and evaluates the material. Texture gradients are ray differentials (Igehy 1999,
// "Tracing Ray Differentials"), exact for planar triangles.
#include "lib/surface.glsl"
#include "lib/material.glsl"
#include "shared/instance_block.h"
#include "shared/vertex.h"

layout(std430, binding = BIND_INSTANCES) readonly buffer instance_storage
{
    instance_block instances[];
};

layout(std430, binding = BIND_ID_BLOCKS) readonly buffer id_block_storage
{
    uint id_block_instances[];
};

layout(std430, binding = BIND_VERTICES) readonly buffer vertex_storage
{
    uint vertices[]; // VERTEX_WORDS each
};

layout(std430, binding = BIND_INDICES) readonly buffer index_storage
{
    uint indices[];
};

struct triangle {
    uint instance;
    uvec3 words;     // first word of each vertex in `vertices`
    mat3 linear;     // linear part of world_from_local
    vec3 corner;     // first corner minus the ray origin
    vec3 edges[2];   // from the first corner
    vec3 volumes[3]; // dotted with a direction: the determinant, and those of the second and third
                     // weight
};

float fetch(uint word)
{
    return uintBitsToFloat(vertices[word]);
}

vec2 fetch2(uint word)
{
    return vec2(fetch(word), fetch(word + 1u));
}

vec3 fetch3(uint word)
{
    return vec3(fetch(word), fetch(word + 1u), fetch(word + 2u));
}

vec4 fetch4(uint word)
{
    return vec4(fetch3(word), fetch(word + 3u));
}

vec3 fetch_direction(uint word)
{
    uint bits = vertices[word];
    return bits == VERTEX_NO_DIRECTION ? vec3(0.0) : octahedral_decode(unpackSnorm2x16(bits));
}

// A ray, its differentials to the right and down, and its pixel.
struct camera_ray {
    vec3 origin; // world
    vec3 direction;
    vec3 dx; // direction differentials
    vec3 dy;
    vec2 pixel;
};

camera_ray pixel_camera_ray(vec2 pixel)
{
    return camera_ray(frame.eye, ray_direction(pixel), frame.ray_dx, frame.ray_dy, pixel);
}

// `id` is a visibility id above 0; `eye` is the ray origin.
triangle fetch_triangle(uint id, vec3 eye)
{
    triangle t;
    t.instance = id_block_instances[(id - 1u) >> ID_BLOCK_BITS];
    uint first = instances[t.instance].first_index +
                 3u * (id - 1u - instances[t.instance].first_visibility_id);
    t.words = uvec3(indices[first], indices[first + 1u], indices[first + 2u]) * VERTEX_WORDS;
    mat4 world_from_local = instances[t.instance].world_from_local;
    t.linear = mat3(world_from_local);
    vec3 origin = world_from_local[3].xyz - eye;
    vec3 local = fetch3(t.words.x);
    t.corner = t.linear * local + origin;
    t.edges[0] = t.linear * (fetch3(t.words.y) - local);
    t.edges[1] = t.linear * (fetch3(t.words.z) - local);
    t.volumes[0] = cross(t.edges[1], t.edges[0]);
    t.volumes[1] = cross(t.corner, t.edges[1]);
    t.volumes[2] = cross(t.edges[0], t.corner);
    return t;
}

// Barycentric weights where a ray from the eye meets the triangle's plane (Moller and Trumbore
// 1997). Valid outside the triangle, too.
vec3 plane_weights(triangle t, vec3 direction)
{
    float determinant = dot(direction, t.volumes[0]);
    float inverse = abs(determinant) > 1e-30 ? 1.0 / determinant : 0.0;
    float b = dot(direction, t.volumes[1]) * inverse;
    float c = dot(direction, t.volumes[2]) * inverse;
    return vec3(1.0 - b - c, b, c);
}

vec3 interpolate_direction(triangle t, uint word, vec3 w)
{
    return fetch_direction(t.words.x + word) * w.x + fetch_direction(t.words.y + word) * w.y +
           fetch_direction(t.words.z + word) * w.z;
}

vec4 interpolate4(triangle t, uint word, vec3 w)
{
    return fetch4(t.words.x + word) * w.x + fetch4(t.words.y + word) * w.y +
           fetch4(t.words.z + word) * w.z;
}

// How a transparent layer changes the light behind it.
struct transparent_layer {
    float alpha;        // coverage (alphaMode BLEND)
    float transmission; // transmitted fraction of the diffuse part
    float thickness_m;
    float ior;
    vec3 attenuation_color;
    float attenuation_distance_m;
};

#if TEXTURED
vec3 mapped_normal(triangle t, vec3 tangent_space, vec3 weights, vec3 normal)
{
    vec3 tangent_local = interpolate_direction(t, VERTEX_TANGENT, weights);
    vec3 tangent = t.linear * tangent_local;
    bool reversed = (vertices[t.words.x + VERTEX_TANGENT] & 0x10000u) != 0u;
    tangent = tangent - normal * dot(normal, tangent);
    float squared = dot(tangent, tangent);
    if (!(squared > 1e-20))
        return normal;
    tangent *= inversesqrt(squared);
    float mirrored = (instances[t.instance].flags & INSTANCE_MIRRORED) != 0u ? -1.0 : 1.0;
    vec3 bitangent = cross(normal, tangent) * (reversed ? -mirrored : mirrored);
    return safe_normalize(
        tangent * tangent_space.x + bitangent * tangent_space.y + normal * tangent_space.z, normal);
}
#endif

// A material evaluated at a point, with its textures.
struct material_point {
    vec4 base;
    vec3 emission;
    float metallic;
    float roughness;
    float occlusion;
    float specular;
    vec3 specular_color;
    float transmission;
    vec3 normal; // world
};

#if TEXTURED
texture_point find_texture_point(triangle t, camera_ray ray, vec3 weights)
{
    texture_point point;
    point.level_dither = dither_level(ray.pixel);
    vec3 weights_dx = plane_weights(t, ray.direction + ray.dx);
    vec3 weights_dy = plane_weights(t, ray.direction + ray.dy);
#if SECOND_UV_SET
    vec4 uv[3] = {fetch4(t.words.x + VERTEX_UV), fetch4(t.words.y + VERTEX_UV),
                  fetch4(t.words.z + VERTEX_UV)};
#else
    vec2 uv[3] = {fetch2(t.words.x + VERTEX_UV), fetch2(t.words.y + VERTEX_UV),
                  fetch2(t.words.z + VERTEX_UV)};
#endif
    point.uv = uv[0] * weights.x + uv[1] * weights.y + uv[2] * weights.z;
    point.dx = uv[0] * weights_dx.x + uv[1] * weights_dx.y + uv[2] * weights_dx.z - point.uv;
    point.dy = uv[0] * weights_dy.x + uv[1] * weights_dy.y + uv[2] * weights_dy.z - point.uv;
    return point;
}

// Loops over the slots in use, so that sampler code is compiled once per colour space.
void apply_textures(triangle t, camera_ray ray, vec3 weights, material_block material,
                    inout material_point p)
{
    texture_point point = find_texture_point(t, ray, weights);
#if COLOR_CLASSES > 0
    for (uint slots = material.texture_mask & COLOR_TEXTURE_SLOTS; slots != 0u;
         slots &= slots - 1u) {
        uint slot = uint(findLSB(slots));
        vec4 texel = sample_color(material.first_texture + slot, point);
        p.base *= slot == TEXTURE_BASE_COLOR ? texel : vec4(1.0);
        p.emission *= slot == TEXTURE_EMISSIVE ? texel.rgb : vec3(1.0);
        p.specular_color *= slot == TEXTURE_SPECULAR_COLOR ? texel.rgb : vec3(1.0);
    }
#endif
#if DATA_CLASSES > 0
    vec3 tangent_space = vec3(0.0, 0.0, 1.0);
    for (uint slots = material.texture_mask & ~COLOR_TEXTURE_SLOTS; slots != 0u;
         slots &= slots - 1u) {
        uint slot = uint(findLSB(slots));
        vec4 texel = sample_data(material.first_texture + slot, point);
        p.roughness *= slot == TEXTURE_METALLIC_ROUGHNESS ? texel.g : 1.0;
        p.metallic *= slot == TEXTURE_METALLIC_ROUGHNESS ? texel.b : 1.0;
        p.occlusion +=
            slot == TEXTURE_OCCLUSION ? material.occlusion_strength * (texel.r - 1.0) : 0.0;
        p.transmission *= slot == TEXTURE_TRANSMISSION ? texel.r : 1.0;
        p.specular *= slot == TEXTURE_SPECULAR ? texel.a : 1.0;
        if (slot == TEXTURE_NORMAL)
            tangent_space =
                vec3((texel.xy * 2.0 - 1.0) * material.normal_scale, texel.z * 2.0 - 1.0);
    }
    if ((material.texture_mask & (1u << TEXTURE_NORMAL)) != 0u)
        p.normal = mapped_normal(t, tangent_space, weights, p.normal);
#endif
}
#endif

material_point find_material_point(triangle t, camera_ray ray, vec3 weights,
                                   material_block material, vec3 normal)
{
    material_point p;
    p.base = material.base_color;
#if VERTEX_COLORS
    p.base *= interpolate4(t, VERTEX_COLOR, weights);
#endif
    p.emission = material.emission;
    p.metallic = material.metallic;
    p.roughness = material.roughness;
    p.occlusion = 1.0;
    p.specular = material.specular;
    p.specular_color = material.specular_color;
    p.transmission = material.transmission;
    p.normal = normal;
#if TEXTURED
    if (material.texture_mask != 0u)
        apply_textures(t, ray, weights, material, p);
#endif
    return p;
}

// Evaluates the surface where a ray hits the triangle. Back faces are flipped towards the viewer.
surface load_surface(uint id, camera_ray ray, out transparent_layer through)
{
    triangle t = fetch_triangle(id, ray.origin);
    vec3 weights = plane_weights(t, ray.direction);
    material_block material = materials[instances[t.instance].material];

    surface s;
    s.view = -normalize(ray.direction);
    s.position = ray.origin + t.corner + weights.y * t.edges[0] + weights.z * t.edges[1];
    vec3 face = -t.volumes[0];
    float mirrored = (instances[t.instance].flags & INSTANCE_MIRRORED) != 0u ? -1.0 : 1.0;
    s.geometric_normal = safe_normalize(face * mirrored, s.view);
    vec3 local_normal = interpolate_direction(t, VERTEX_NORMAL, weights);
    // The cofactor matrix transforms normals like the inverse transpose, and exists for flat
    // scales, too.
    vec3 turned = cross(t.linear[1], t.linear[2]) * local_normal.x +
                  cross(t.linear[2], t.linear[0]) * local_normal.y +
                  cross(t.linear[0], t.linear[1]) * local_normal.z;
    material_point p = find_material_point(t, ray, weights, material,
                                           safe_normalize(turned * mirrored, s.geometric_normal));
    s.normal = p.normal;
    if (dot(s.geometric_normal, s.view) < 0.0) {
        s.geometric_normal = -s.geometric_normal;
        s.normal = -s.normal;
    }
    s.base_color = clamp(p.base.rgb, 0.0, 1.0);
    s.metallic = clamp(p.metallic, 0.0, 1.0);
    s.roughness = clamp(p.roughness, 0.0, 1.0);
    s.occlusion = clamp(p.occlusion, 0.0, 1.0);
    s.f0 = min(material.f0 * p.specular_color, 1.0) * p.specular;
    s.f90 = (material.flags & MATERIAL_IOR_ONE) != 0u ? 0.0 : p.specular;
    s.shading = material.flags & MATERIAL_SHADING_MASK;
    s.thin = (material.flags & MATERIAL_DOUBLE_SIDED) != 0u;
    s.emission = s.shading == SHADE_UNLIT ? s.base_color : p.emission;

    bool blend = (material.flags & MATERIAL_ALPHA_BLEND) != 0u;
    through.alpha = blend ? clamp(p.base.a, 0.0, 1.0) : 1.0;
    through.transmission = p.transmission * (1.0 - s.metallic);
    through.thickness_m = material.thickness_m;
    through.ior = material.ior;
    through.attenuation_color = material.attenuation_color;
    through.attenuation_distance_m = material.attenuation_distance_m;
    return s;
}
