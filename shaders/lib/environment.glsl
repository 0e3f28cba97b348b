// Environment light: background, ambient diffuse and specular.
#include "lib/brdf.glsl"
#include "shared/environment_block.h"

layout(std430, binding = BIND_ENVIRONMENT) readonly buffer environment_storage
{
    environment_block environment;
};

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
    if (environment.equirectangular != 0u) {
        vec2 uv = vec2(0.5 + atan(d.x, -d.z) / (2.0 * PI), acos(clamp(d.y, -1.0, 1.0)) / PI);
        return textureLod(environment_background, uv, 0.0).rgb * frame.environment_intensity;
    }
    vec3 pole = d.y >= 0.0 ? environment.zenith : environment.ground;
    return mix(environment.horizon, pole, abs(d.y)) * frame.environment_intensity;
}

// Irradiance / pi for a surface with unit normal n.
vec3 environment_diffuse(vec3 normal)
{
    vec3 n = to_environment(normal);
    vec3 sum = environment.irradiance_sh[0].rgb;
    sum += environment.irradiance_sh[1].rgb * n.y + environment.irradiance_sh[2].rgb * n.z +
           environment.irradiance_sh[3].rgb * n.x;
    sum += environment.irradiance_sh[4].rgb * (n.x * n.y) +
           environment.irradiance_sh[5].rgb * (n.y * n.z) +
           environment.irradiance_sh[6].rgb * (3.0 * n.z * n.z - 1.0) +
           environment.irradiance_sh[7].rgb * (n.x * n.z) +
           environment.irradiance_sh[8].rgb * (n.x * n.x - n.y * n.y);
    return max(sum, 0.0) * frame.environment_intensity;
}

// Scale and bias of F0 (the split sum of Karis 2013, "Real Shading in Unreal Engine 4").
vec2 environment_brdf(float roughness, float n_v)
{
    vec2 at = clamp(vec2(sqrt(n_v), roughness), 0.0, 1.0) * float(ENVIRONMENT_BRDF_EDGE - 1);
    uvec2 node = min(uvec2(at), uvec2(ENVIRONMENT_BRDF_EDGE - 2));
    vec2 t = at - vec2(node);
    uint index = node.y * uint(ENVIRONMENT_BRDF_EDGE) + node.x;
    vec4 smoother = environment.brdf_nodes[index];
    vec4 rougher = environment.brdf_nodes[index + uint(ENVIRONMENT_BRDF_EDGE)];
    return mix(mix(smoother.xy, smoother.zw, t.x), mix(rougher.xy, rougher.zw, t.x), t.y);
}

vec3 environment_specular(vec3 direction, float roughness)
{
    vec2 p = octahedral_encode(to_environment(direction)) * 0.5 + 0.5;
    float edge = float(textureSize(environment_levels, 0).x);
    p = clamp(p, 0.5 / edge, 1.0 - 0.5 / edge);
    float level = roughness * (environment.level_count - 1.0);
    float lower = floor(level);
    vec3 a = textureLod(environment_levels, vec3(p, lower), 0.0).rgb;
    vec3 b = textureLod(environment_levels,
                        vec3(p, min(lower + 1.0, environment.level_count - 1.0)), 0.0)
                 .rgb;
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
