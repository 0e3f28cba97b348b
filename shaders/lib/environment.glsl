// Light from the environment: background, diffuse and specular ambient.
#include "lib/brdf.glsl"

layout(std430, binding = BIND_ENVIRONMENT) readonly buffer environment_storage
{
    // Spherical harmonics of the irradiance divided by pi (Ramamoorthi and Hanrahan 2001), bands
    // 0 to 2, of an unrotated environment of intensity 1; then type, levels, -, -; then colours
    // of zenith, horizon and ground.
    vec4 environment_data[13];
    // Directional albedo of the GGX lobe as scale and bias of F0: a row for each roughness, in it xy
    // at a node of sqrt(n.v) and zw at the next.
    vec4 environment_brdf_nodes[ENVIRONMENT_BRDF_EDGE * ENVIRONMENT_BRDF_EDGE];
};

layout(binding = UNIT_ENVIRONMENT) uniform sampler2DArray environment_levels; // by roughness
layout(binding = UNIT_BACKGROUND) uniform sampler2D environment_background;   // equirectangular

const float ENVIRONMENT_EQUIRECT = 3.0;

vec3 to_environment(vec3 direction)
{
    float sine = sin(frame.environment.y);
    float cosine = cos(frame.environment.y);
    return vec3(cosine * direction.x - sine * direction.z, direction.y,
                sine * direction.x + cosine * direction.z);
}

// Radiance from a direction, in cd/m^2.
vec3 environment_radiance(vec3 direction)
{
    vec3 d = to_environment(direction);
    if (environment_data[9].x == ENVIRONMENT_EQUIRECT) {
        vec2 uv = vec2(0.5 + atan(d.x, -d.z) / (2.0 * PI), acos(clamp(d.y, -1.0, 1.0)) / PI);
        return textureLod(environment_background, uv, 0.0).rgb * frame.environment.x;
    }
    vec3 pole = d.y >= 0.0 ? environment_data[10].rgb : environment_data[12].rgb;
    return mix(environment_data[11].rgb, pole, abs(d.y)) * frame.environment.x;
}

// Irradiance / pi for a surface with unit normal n.
vec3 environment_diffuse(vec3 normal)
{
    vec3 n = to_environment(normal);
    vec3 sum = environment_data[0].rgb;
    sum += environment_data[1].rgb * n.y + environment_data[2].rgb * n.z +
           environment_data[3].rgb * n.x;
    sum += environment_data[4].rgb * (n.x * n.y) + environment_data[5].rgb * (n.y * n.z) +
           environment_data[6].rgb * (3.0 * n.z * n.z - 1.0) + environment_data[7].rgb * (n.x * n.z) +
           environment_data[8].rgb * (n.x * n.x - n.y * n.y);
    return max(sum, 0.0) * frame.environment.x;
}

// Scale and bias of F0 (the split sum of Karis 2013, "Real Shading in Unreal Engine 4").
vec2 environment_brdf(float roughness, float n_v)
{
    vec2 at = clamp(vec2(sqrt(n_v), roughness), 0.0, 1.0) * float(ENVIRONMENT_BRDF_EDGE - 1);
    uvec2 node = min(uvec2(at), uvec2(ENVIRONMENT_BRDF_EDGE - 2));
    vec2 t = at - vec2(node);
    uint index = node.y * uint(ENVIRONMENT_BRDF_EDGE) + node.x;
    vec4 smoother = environment_brdf_nodes[index];
    vec4 rougher = environment_brdf_nodes[index + uint(ENVIRONMENT_BRDF_EDGE)];
    return mix(mix(smoother.xy, smoother.zw, t.x), mix(rougher.xy, rougher.zw, t.x), t.y);
}

vec3 environment_specular(vec3 direction, float roughness)
{
    vec2 p = octahedral_encode(to_environment(direction)) * 0.5 + 0.5;
    float edge = float(textureSize(environment_levels, 0).x);
    p = clamp(p, 0.5 / edge, 1.0 - 0.5 / edge);
    float level = roughness * (environment_data[9].y - 1.0);
    float lower = floor(level);
    vec3 a = textureLod(environment_levels, vec3(p, lower), 0.0).rgb;
    vec3 b = textureLod(environment_levels, vec3(p, min(lower + 1.0, environment_data[9].y - 1.0)),
                        0.0).rgb;
    return mix(a, b, level - lower) * frame.environment.x;
}

// Radiance towards the viewer by environment light, without occlusion but the material's map.
vec3 environment_light(surface s)
{
    float n_v = clamp(dot(s.normal, s.view), 0.0, 1.0);
    vec2 scale_bias = environment_brdf(s.roughness, n_v);
    vec3 f0 = mix(s.f0, s.base_color, s.metallic);
    float f90 = mix(s.f90, 1.0, s.metallic);
    vec3 reflected = f0 * scale_bias.x + f90 * scale_bias.y;
    vec3 diffuse = s.base_color * ((1.0 - s.metallic) * mean_diffuse_share(s, n_v)) *
                   environment_diffuse(s.normal);
    vec3 mirror = reflect(-s.view, s.normal);
    return (diffuse + reflected * environment_specular(mirror, s.roughness)) * s.occlusion;
}
