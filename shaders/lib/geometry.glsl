// Visibility id to surface: fetches the triangle, intersects the pixel's ray with it, interpolates
// attributes and evaluates the material. Texture gradients are ray differentials (Igehy 1999,
// "Tracing Ray Differentials"), exact for planar triangles.
#include "lib/surface.glsl"
#include "lib/material.glsl"
#include "shared/instance_block.h"
#include "shared/vertex.h"

layout(binding = UNIT_VERTICES) uniform usamplerBuffer vertices;   // VERTEX_TEXELS each
layout(binding = UNIT_TRIANGLES) uniform usamplerBuffer triangles; // vertices of the corners

// An instance without its transform.
struct instance_words {
    uint first_triangle;
    uint material;
    uint first_visibility_id;
    uint flags;
};

instance_words load_instance(uint number)
{
    uvec4 words = table_words(frame.first_instance + 5u * number + 4u);
    return instance_words(words.x, words.y, words.z, words.w);
}

mat4 load_transform(uint number)
{
    return table_matrix(frame.first_instance + 5u * number);
}

struct triangle {
    instance_words instance;
    uvec3 texels;    // first texel of each vertex
    uvec3 normals;   // of the vertices, as they are packed
    mat3 linear;     // linear part of world_from_local
    vec3 corner;     // first corner minus the ray origin
    vec3 edges[2];   // from the first corner
    vec3 volumes[3]; // dotted with a direction: the determinant, and those of the second and third
                     // weight
};

vec4 vertex_floats(uint texel)
{
    return uintBitsToFloat(texelFetch(vertices, int(texel)));
}

// Texture coordinates of both sets, or of the first alone.
#if SECOND_UV_SET
vec4 vertex_uv(uint texel)
{
    return vec4(vertex_floats(texel + 1u).xy, vertex_floats(texel + 2u).xy);
}
#else
vec2 vertex_uv(uint texel)
{
    return vertex_floats(texel + 1u).xy;
}
#endif

vec3 unpack_direction(uint bits)
{
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
    uint block = (id - 1u) >> ID_BLOCK_BITS;
    uint number = table_words(frame.first_id_block + (block >> 2))[block & 3u];
    t.instance = load_instance(number);
    uint at = t.instance.first_triangle + (id - 1u - t.instance.first_visibility_id);
    t.texels = texelFetch(triangles, int(at)).xyz * VERTEX_TEXELS;
    uvec4 first = texelFetch(vertices, int(t.texels.x));
    uvec4 second = texelFetch(vertices, int(t.texels.y));
    uvec4 third = texelFetch(vertices, int(t.texels.z));
    t.normals = uvec3(first.w, second.w, third.w);
    mat4 world_from_local = load_transform(number);
    t.linear = mat3(world_from_local);
    vec3 origin = world_from_local[3].xyz - eye;
    vec3 local = uintBitsToFloat(first.xyz);
    t.corner = t.linear * local + origin;
    t.edges[0] = t.linear * (uintBitsToFloat(second.xyz) - local);
    t.edges[1] = t.linear * (uintBitsToFloat(third.xyz) - local);
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

vec3 interpolate_direction(uvec3 bits, vec3 w)
{
    return unpack_direction(bits.x) * w.x + unpack_direction(bits.y) * w.y +
           unpack_direction(bits.z) * w.z;
}

#if VERTEX_COLORS
vec4 interpolate_color(uvec3 texels, vec3 w)
{
    return vertex_floats(texels.x + 3u) * w.x + vertex_floats(texels.y + 3u) * w.y +
           vertex_floats(texels.z + 3u) * w.z;
}
#endif

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
    uvec3 bits = uvec3(texelFetch(vertices, int(t.texels.x + 1u)).z,
                       texelFetch(vertices, int(t.texels.y + 1u)).z,
                       texelFetch(vertices, int(t.texels.z + 1u)).z);
    vec3 tangent_local = interpolate_direction(bits, weights);
    vec3 tangent = t.linear * tangent_local;
    bool reversed = (bits.x & 0x10000u) != 0u;
    tangent = tangent - normal * dot(normal, tangent);
    float squared = dot(tangent, tangent);
    if (!(squared > 1e-20))
        return normal;
    tangent *= inversesqrt(squared);
    float mirrored = (t.instance.flags & INSTANCE_MIRRORED) != 0u ? -1.0 : 1.0;
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
    UV_VECTOR uv[3] = {vertex_uv(t.texels.x), vertex_uv(t.texels.y), vertex_uv(t.texels.z)};
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
    uint colors = material.texture_mask & COLOR_TEXTURE_SLOTS;
    if (colors != 0u) {
        do {
            uint slot = uint(findLSB(colors));
            vec4 texel = sample_color(material.first_texture + slot, point);
            p.base *= slot == TEXTURE_BASE_COLOR ? texel : vec4(1.0);
            p.emission *= slot == TEXTURE_EMISSIVE ? texel.rgb : vec3(1.0);
            p.specular_color *= slot == TEXTURE_SPECULAR_COLOR ? texel.rgb : vec3(1.0);
        } while ((colors &= colors - 1u) != 0u);
    }
#endif
#if DATA_CLASSES > 0
    vec3 tangent_space = vec3(0.0, 0.0, 1.0);
    uint data = material.texture_mask & ~COLOR_TEXTURE_SLOTS;
    if (data != 0u) {
        do {
            uint slot = uint(findLSB(data));
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
        } while ((data &= data - 1u) != 0u);
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
    p.base *= interpolate_color(t.texels, weights);
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
    material_block material = load_material(t.instance.material);

    surface s;
    s.view = -normalize(ray.direction);
    s.position = ray.origin + t.corner + weights.y * t.edges[0] + weights.z * t.edges[1];
    vec3 face = -t.volumes[0];
    float mirrored = (t.instance.flags & INSTANCE_MIRRORED) != 0u ? -1.0 : 1.0;
    s.geometric_normal = safe_normalize(face * mirrored, s.view);
    vec3 local_normal = interpolate_direction(t.normals, weights);
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
