// The G-buffer: two uvec4 per pixel.
//   0: base colour and metallic, specular weight; shading and geometric normal (octahedral)
//   1: dielectric F0 and roughness; emission (shared exponent); thin; occlusion; shading model
#include "lib/surface.glsl"

layout(std430, binding = BIND_GBUFFER) writeonly buffer gbuffer_storage
{
    uvec4 gbuffer[];
};

layout(binding = UNIT_GBUFFER) uniform usamplerBuffer gbuffer_texels; // the same, to read
layout(binding = UNIT_DEPTH) uniform sampler2D depth_texture;

uint pixel_index(uvec2 pixel)
{
    return pixel.y * frame.render_size.x + pixel.x;
}

// Three mantissas of 13 bits and a shared exponent of 8, in 32 + 15 bits: the range of floats, to
// 1/8191 of the brightest channel. The maximum exponent marks a channel that is not finite.
const int EMISSION_BIAS = 127;
const uint THIN_BIT = 0x8000u;

uvec2 pack_emission(vec3 emission)
{
    float brightest = max(emission.r, max(emission.g, emission.b));
    int exponent;
    frexp(brightest, exponent);
    exponent = brightest > 0.0 ? max(exponent, 1 - EMISSION_BIAS) : 1 - EMISSION_BIAS;
    uvec3 mantissa = min(uvec3(max(ldexp(emission, ivec3(-exponent)), 0.0) * 8192.0 + 0.5), 8191u);
    bool finite = all(lessThan(floatBitsToUint(emission) & 0x7f800000u, uvec3(0x7f800000u)));
    uint biased = finite ? uint(exponent + EMISSION_BIAS) : 255u;
    return uvec2(mantissa.r | (mantissa.g << 13) | (mantissa.b << 26),
                 (mantissa.b >> 6) | (biased << 7));
}

vec3 unpack_emission(uvec4 second)
{
    uint biased = (second.w >> 7) & 0xffu;
    uvec3 mantissa = uvec3(second.z & 0x1fffu, (second.z >> 13) & 0x1fffu,
                           (second.z >> 26) | ((second.w & 0x7fu) << 6));
    vec3 emission = ldexp(vec3(mantissa) / 8192.0, ivec3(int(biased) - EMISSION_BIAS));
    return biased == 255u ? vec3(uintBitsToFloat(0x7f800000u)) : emission;
}

void gbuffer_store(uvec2 pixel, surface s)
{
    uint at = 2u * pixel_index(pixel);
    uint blue_and_weights = (packUnorm2x16(vec2(s.base_color.b, 0.0)) & 0xffffu) |
                            (packUnorm4x8(vec4(s.metallic, s.f90, 0.0, 0.0)) << 16);
    gbuffer[at] = uvec4(packUnorm2x16(s.base_color.rg), blue_and_weights,
                        packSnorm2x16(octahedral_encode(s.normal)),
                        packSnorm2x16(octahedral_encode(s.geometric_normal)));
    uvec2 emission = pack_emission(s.emission);
    gbuffer[at + 1u] =
        uvec4(packUnorm2x16(s.f0.rg), packUnorm2x16(vec2(s.f0.b, s.roughness)), emission.x,
              emission.y | (s.thin ? THIN_BIT : 0u) | (uint(s.occlusion * 255.0 + 0.5) << 16) |
                  (s.shading << 24));
}

void gbuffer_store_background(uvec2 pixel)
{
    uint at = 2u * pixel_index(pixel);
    gbuffer[at] = uvec4(0u);
    gbuffer[at + 1u] = uvec4(0u, 0u, 0u, SHADE_BACKGROUND << 24);
}

// For background pixels only `shading`, `view` and `emission` (black) are valid.
surface gbuffer_load(uvec2 pixel)
{
    uint at = 2u * pixel_index(pixel);
    uvec4 first = texelFetch(gbuffer_texels, int(at));
    uvec4 second = texelFetch(gbuffer_texels, int(at + 1u));
    surface s;
    vec3 direction = ray_direction(vec2(pixel));
    float depth = texelFetch(depth_texture, ivec2(pixel), 0).r;
    s.shading = second.w >> 24;
    s.view = -normalize(direction);
    s.position = frame.eye + direction * (depth > 0.0 ? view_distance(depth) : 1.0);
    vec4 weights = unpackUnorm4x8(first.y >> 16);
    s.base_color = vec3(unpackUnorm2x16(first.x), unpackUnorm2x16(first.y).x);
    s.metallic = weights.x;
    s.f90 = weights.y;
    s.normal = octahedral_decode(unpackSnorm2x16(first.z));
    s.geometric_normal = octahedral_decode(unpackSnorm2x16(first.w));
    vec2 blue_and_roughness = unpackUnorm2x16(second.y);
    s.f0 = vec3(unpackUnorm2x16(second.x), blue_and_roughness.x);
    s.roughness = blue_and_roughness.y;
    s.emission = unpack_emission(second);
    s.occlusion = float((second.w >> 16) & 0xffu) / 255.0;
    s.thin = (second.w & THIN_BIT) != 0u;
    return s;
}
