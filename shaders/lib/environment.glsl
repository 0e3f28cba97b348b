// Environment light: background, ambient diffuse and specular.
#include "lib/brdf.glsl"
#include "lib/scene_tables.glsl"
#include "shared/environment_block.h"

// Texels of environment_block.
const uint ENVIRONMENT_KIND = uint(ENVIRONMENT_SH_COEFFICIENTS); // equirectangular, level count
const uint ENVIRONMENT_ZENITH = ENVIRONMENT_KIND + 1u;
const uint ENVIRONMENT_HORIZON = ENVIRONMENT_KIND + 2u;
const uint ENVIRONMENT_GROUND = ENVIRONMENT_KIND + 3u;
const uint ENVIRONMENT_BRDF = ENVIRONMENT_KIND + 4u;

vec4 environment_floats(uint texel)
{
    return table_floats(frame.environment_texel + texel);
}

layout(binding = UNIT_ENVIRONMENT) uniform sampler2DArray
    environment_levels; // prefiltered by roughness
layout(binding = UNIT_BACKGROUND) uniform sampler2D environment_background; // equirectangular

vec3 to_environment(vec3 direction)
{
    float sine = sin(frame.environment_rotation_rad);
    float cosine = cos(frame.environment_rotation_rad);
    return vec3(cosine * direction.x - sine * direction.z, direction.y,
                sine * direction.x + cosine * direction.z);
}

// Radiance from a direction, in cd/m^2.
vec3 environment_radiance(vec3 direction)
{
    vec3 d = to_environment(direction);
    if (table_words(frame.environment_texel + ENVIRONMENT_KIND).x != 0u) {
        vec2 uv = vec2(0.5 + atan(d.x, -d.z) / (2.0 * PI), acos(clamp(d.y, -1.0, 1.0)) / PI);
        return textureLod(environment_background, uv, 0.0).rgb * frame.environment_intensity;
    }
    vec3 pole = environment_floats(d.y >= 0.0 ? ENVIRONMENT_ZENITH : ENVIRONMENT_GROUND).rgb;
    return mix(environment_floats(ENVIRONMENT_HORIZON).rgb, pole, abs(d.y)) *
           frame.environment_intensity;
}

// Irradiance / pi for a surface with unit normal n.
vec3 environment_diffuse(vec3 normal)
{
    vec3 n = to_environment(normal);
    vec3 sum = environment_floats(0u).rgb;
    sum += environment_floats(1u).rgb * n.y + environment_floats(2u).rgb * n.z +
           environment_floats(3u).rgb * n.x;
    sum += environment_floats(4u).rgb * (n.x * n.y) + environment_floats(5u).rgb * (n.y * n.z) +
           environment_floats(6u).rgb * (3.0 * n.z * n.z - 1.0) +
           environment_floats(7u).rgb * (n.x * n.z) +
           environment_floats(8u).rgb * (n.x * n.x - n.y * n.y);
    return max(sum, 0.0) * frame.environment_intensity;
}

// Scale and bias of F0 (the split sum of Karis 2013, "Real Shading in Unreal Engine 4").
vec2 environment_brdf(float roughness, float n_v)
{
    vec2 at = clamp(vec2(sqrt(n_v), roughness), 0.0, 1.0) * float(ENVIRONMENT_BRDF_EDGE - 1);
    uvec2 node = min(uvec2(at), uvec2(ENVIRONMENT_BRDF_EDGE - 2));
    vec2 t = at - vec2(node);
    uint index = node.y * uint(ENVIRONMENT_BRDF_EDGE) + node.x;
    vec4 smoother = environment_floats(ENVIRONMENT_BRDF + index);
    vec4 rougher = environment_floats(ENVIRONMENT_BRDF + index + uint(ENVIRONMENT_BRDF_EDGE));
    return mix(mix(smoother.xy, smoother.zw, t.x), mix(rougher.xy, rougher.zw, t.x), t.y);
}

vec3 environment_specular(vec3 direction, float roughness)
{
    vec2 p = octahedral_encode(to_environment(direction)) * 0.5 + 0.5;
    float edge = float(textureSize(environment_levels, 0).x);
    p = clamp(p, 0.5 / edge, 1.0 - 0.5 / edge);
    float last = environment_floats(ENVIRONMENT_KIND).y - 1.0;
    float level = roughness * last;
    float lower = floor(level);
    vec3 a = textureLod(environment_levels, vec3(p, lower), 0.0).rgb;
    vec3 b = textureLod(environment_levels, vec3(p, min(lower + 1.0, last)), 0.0).rgb;
    return mix(a, b, level - lower) * frame.environment_intensity;
}

// Radiance towards the viewer from the environment, occluded by the material's map only.
vec3 environment_light(surface s)
{
    float n_v = clamp(dot(s.normal, s.view), 0.0, 1.0);
    vec2 scale_bias = environment_brdf(s.roughness, n_v);
    vec3 f0 = mix(s.f0, s.base_color, s.metallic);
    float f90 = mix(s.f90, 1.0, s.metallic);
    vec3 reflected = f0 * scale_bias.x + f90 * scale_bias.y;
    vec3 diffuse = s.base_color * ((1.0 - s.metallic) * mean_diffuse_fraction(s, n_v)) *
                   environment_diffuse(s.normal);
    vec3 mirror = reflect(-s.view, s.normal);
    return (diffuse + reflected * environment_specular(mirror, s.roughness)) * s.occlusion;
}
