// Adds indirect specular light in the tiles that need it (one group each), by cones or (RAYS 1)
// from the accumulation. In: tiles, G-buffer, radiance texture. Out: radiance in cd/m^2.
#define CONE_SMOOTH 1
#define CONE_SKIP   1
#include "lib/gbuffer.glsl"
#include "lib/environment.glsl"
#include "lib/ray_accumulation.glsl"
#include "lib/specular_cone.glsl"
#include "lib/specular_classify.glsl"
#include "lib/radiance_buffer.glsl"

layout(local_size_x = GROUP_EDGE / 2, local_size_y = GROUP_EDGE / 2) in;

layout(std430, binding = BIND_GLOSSY_TILES) readonly buffer tile_storage
{
    uint tile_count; // groups in x of the indirect dispatch; then y and z
    uint tile_groups_y;
    uint tile_groups_z;
    uint tile_unused;
    uint tiles[];
};

#if RAYS
#define SPECULAR_OCCLUSION 1.0 // rays trace occlusion themselves
// Accumulated specular radiance of the square that the pixel belongs to.
vec3 mirrored_light(surface s, uvec2 pixel)
{
    return former_sum(accumulation_index(PLANE_SPECULAR_MEAN, pixel / uint(GATHER_STEP))).rgb;
}
#else
#define SPECULAR_OCCLUSION s.occlusion
vec3 mirrored_light(surface s, uvec2 pixel)
{
    vec3 mirror = reflect(-s.view, s.normal);
    // A normal map can turn the mirror direction into the surface.
    mirror += s.geometric_normal * max(0.01 - dot(mirror, s.geometric_normal), 0.0);
    return trace_specular(s.position, s.geometric_normal, s.thin, normalize(mirror), s.roughness);
}
#endif

// An invocation shades 2x2 pixels. With SHARED 1 those of similar normal and roughness reuse the
// cone of the first.
void main()
{
    uint tile = tiles[gl_WorkGroupID.x];
    uvec2 first = uvec2(tile & 0xffffu, tile >> 16) * GROUP_EDGE + gl_LocalInvocationID.xy * 2u;
    vec3 known_normal = vec3(0.0);
    float known_roughness = 0.0;
    vec3 light = vec3(0.0);
    uint i = 0u;
    do {
        uvec2 pixel = first + uvec2(i & 1u, i >> 1);
        if (any(greaterThanEqual(pixel, frame.render_size)))
            continue;
        surface s = gbuffer_load(pixel);
        if (s.shading >= SHADE_UNLIT || !needs_specular_trace(s))
            continue;
        bool shared_light = SHARED != 0 && dot(s.normal, known_normal) > 0.99 &&
                            abs(s.roughness - known_roughness) < 0.1;
        if (!shared_light) {
            light = mirrored_light(s, pixel);
            known_normal = s.normal;
            known_roughness = s.roughness;
        }
        float n_v = clamp(dot(s.normal, s.view), 0.0, 1.0);
        vec2 scale_bias = environment_brdf(s.roughness, n_v);
        vec3 f0 = mix(s.f0, s.base_color, s.metallic);
        float f90 = mix(s.f90, 1.0, s.metallic);
        vec3 reflected = f0 * scale_bias.x + f90 * scale_bias.y;
        uint at = pixel_index(pixel);
        vec3 added = reflected * light * (SPECULAR_OCCLUSION * settings.indirect_intensity);
        radiance[at] = vec4(former_radiance(at) + added, 1.0);
    } while (++i < 4u);
}
