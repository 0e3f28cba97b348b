// Materials and their textures, as glTF 2.0 and its KHR_materials_* extensions define them.
// TEXTURE_CLASSES: how many texture arrays (one per size and colour space) the scene has.
#include "lib/frame.glsl"

layout(std430, binding = BIND_MATERIALS) readonly buffer material_storage
{
    material_block materials[];
};

#if TEXTURE_CLASSES > 0
layout(std430, binding = BIND_TEXTURES) readonly buffer texture_storage
{
    texture_block textures[];
};

layout(binding = UNIT_MATERIAL_CLASSES) uniform sampler2DArray texture_classes[TEXTURE_CLASSES];

// Texture coordinates of both sets, and their change per pixel to the right and downwards.
struct texture_point {
    vec4 uv;
    vec4 dx;
    vec4 dy;
};

const float MAX_FOOTPRINT_TEXELS = 1e7;

float wrap_coordinate(float u, uint mode, float edge)
{
    if (mode == 0u)
        return u; // the sampler repeats
    if (mode == 2u)
        u = abs(mod(u + 1.0, 2.0) - 1.0);
    float half_texel = 0.5 / edge;
    return clamp(u, half_texel, 1.0 - half_texel);
}

vec4 sample_class(uint class_number, vec3 at, float lod)
{
#if TEXTURE_CLASSES > 1
    if (class_number == 1u)
        return textureLod(texture_classes[1], at, lod);
#endif
#if TEXTURE_CLASSES > 2
    if (class_number == 2u)
        return textureLod(texture_classes[2], at, lod);
#endif
#if TEXTURE_CLASSES > 3
    if (class_number == 3u)
        return textureLod(texture_classes[3], at, lod);
#endif
#if TEXTURE_CLASSES > 4
    if (class_number == 4u)
        return textureLod(texture_classes[4], at, lod);
#endif
#if TEXTURE_CLASSES > 5
    if (class_number == 5u)
        return textureLod(texture_classes[5], at, lod);
#endif
#if TEXTURE_CLASSES > 6
    if (class_number == 6u)
        return textureLod(texture_classes[6], at, lod);
#endif
#if TEXTURE_CLASSES > 7
    if (class_number == 7u)
        return textureLod(texture_classes[7], at, lod);
#endif
#if TEXTURE_CLASSES > 8
    if (class_number == 8u)
        return textureLod(texture_classes[8], at, lod);
#endif
#if TEXTURE_CLASSES > 9
    if (class_number == 9u)
        return textureLod(texture_classes[9], at, lod);
#endif
    return textureLod(texture_classes[0], at, lod);
}

// Anisotropic filtering: trilinear samples along the longer axis of the pixel's footprint, at the
// level that fits the shorter one (as EXT_texture_filter_anisotropic describes it). Done here
// because the loops of software samplers grow without bound with the gradients. `place` is class
// and layer.
vec4 sample_anisotropic(uvec2 place, vec2 at, vec2 dx, vec2 dy, float edge)
{
    float length_x = length(dx) * edge;
    float length_y = length(dy) * edge;
    vec2 axis = length_x > length_y ? dx : dy;
    float major = max(max(length_x, length_y), 1e-6);
    if (!(major < MAX_FOOTPRINT_TEXELS)) // gradients of triangles seen edge-on can be anything
        return sample_class(place.x, vec3(at, float(place.y)), log2(edge));
    float minor = max(min(length_x, length_y), major / frame.textures.x);
    float lod = log2(minor);
    float samples = lod > 0.0 || major > 1.0 ? clamp(ceil(major / max(minor, 1.0)), 1.0, frame.textures.x) : 1.0;
    vec4 sum = vec4(0.0);
    for (float i = 0.5; i < samples; i += 1.0)
        sum += sample_class(place.x, vec3(at + axis * (i / samples - 0.5), float(place.y)), lod);
    return sum / samples;
}

// White where the slot has no texture.
vec4 sample_slot(material_block material, uint slot, texture_point point)
{
    if ((material.info.z & (1u << slot)) == 0u)
        return vec4(1.0);
    texture_block texture = textures[material.info.y + slot];
    uint flags = texture.info.z;
    bool second = (flags & TEXTURE_UV_SET_1) != 0u;
    vec2 uv = second ? point.uv.zw : point.uv.xy;
    vec2 dx = second ? point.dx.zw : point.dx.xy;
    vec2 dy = second ? point.dy.zw : point.dy.xy;
    vec3 row_u = texture.uv_row_u.xyz;
    vec3 row_v = texture.uv_row_v.xyz;
    vec2 at = vec2(dot(row_u, vec3(uv, 1.0)), dot(row_v, vec3(uv, 1.0)));
    dx = vec2(dot(row_u.xy, dx), dot(row_v.xy, dx));
    dy = vec2(dot(row_u.xy, dy), dot(row_v.xy, dy));
    float edge = float(texture.info.w);
    if ((flags & TEXTURE_NEAREST) != 0u && max(length(dx), length(dy)) * edge < 1.0)
        at = (floor(at * edge) + 0.5) / edge;
    at.x = wrap_coordinate(at.x, (flags >> TEXTURE_WRAP_U_BIT) & 3u, edge);
    at.y = wrap_coordinate(at.y, (flags >> TEXTURE_WRAP_V_BIT) & 3u, edge);
    // Far texture coordinates lose their fraction in the sampler's fixed point: keep them small.
    at -= floor(at * (1.0 / 64.0)) * 64.0;
    return sample_anisotropic(texture.info.xy, at, dx, dy, edge);
}
#endif
