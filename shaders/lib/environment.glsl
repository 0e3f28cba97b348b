// Light from the environment: background, diffuse and specular ambient.
#include "lib/brdf.glsl"

layout(std430, binding = BIND_ENVIRONMENT) readonly buffer environment_storage
{
    // Spherical harmonics of the irradiance divided by pi (Ramamoorthi and Hanrahan 2001), bands
    // 0 to 2, of an unrotated environment of intensity 1; then type, levels, -, -; then colours
    // of zenith, horizon and ground.
    vec4 environment_data[13];
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

// Directional albedo of the GGX lobe as scale and bias of F0 (Lazarov 2013, fitted by Karis 2014,
// "Physically Based Shading on Mobile").
vec2 environment_brdf(float roughness, float n_v)
{
    vec4 r = roughness * vec4(-1.0, -0.0275, -0.572, 0.022) + vec4(1.0, 0.0425, 1.04, -0.04);
    float a = min(r.x * r.x, exp2(-9.28 * n_v)) * r.x + r.y;
    return vec2(-1.04, 1.04) * a + r.zw;
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
    // The fit dips a little below 0 at some angles.
    vec3 reflected = max(f0 * scale_bias.x + f90 * scale_bias.y, 0.0);
    vec3 dielectric = max(s.f0 * scale_bias.x + s.f90 * scale_bias.y, 0.0);
    float kept = 1.0 - max(dielectric.r, max(dielectric.g, dielectric.b));
    vec3 diffuse = s.base_color * ((1.0 - s.metallic) * kept) * environment_diffuse(s.normal);
    vec3 mirror = reflect(-s.view, s.normal);
    return (diffuse + reflected * environment_specular(mirror, s.roughness)) * s.occlusion;
}
