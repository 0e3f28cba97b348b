// Samples the specular lobe at every GATHER_STEP-th pixel, one ray per frame against the triangles,
// in the tiles that need it (one group each). Hits are lit by each light (LIT_HITS 1) or from the
// voxels (0). In: tiles, G-buffer, BVH, materials, lights, shadow maps, irradiance cache. Out: sums
// over the frames in which nothing moved.
#include "lib/gbuffer.glsl"
#include "lib/ray_accumulation.glsl"
#include "lib/specular_classify.glsl"
#include "lib/hit_shading.glsl"
#include "lib/ray_sequence.glsl"

layout(local_size_x = GROUP_EDGE / GATHER_STEP, local_size_y = GROUP_EDGE / GATHER_STEP) in;

layout(std430, binding = BIND_GLOSSY_TILES) readonly buffer tile_storage
{
    uint tile_count; // groups in x of the indirect dispatch; then y and z
    uint tile_groups_y;
    uint tile_groups_z;
    uint tile_unused;
    uint tiles[];
};

// Samples a visible microfacet normal about +Z for GGX roughness alpha (Heitz 2018, "Sampling the
// GGX Distribution of Visible Normals").
vec3 sample_visible_normal(vec3 view, float alpha, vec2 u)
{
    vec3 stretched = normalize(vec3(alpha * view.xy, view.z));
    vec2 t = sqrt(u.x) * vec2(cos(2.0 * PI * u.y), sin(2.0 * PI * u.y));
    vec3 across = safe_normalize(vec3(-stretched.y, stretched.x, 0.0), vec3(1.0, 0.0, 0.0));
    vec3 along = cross(stretched, across);
    float s = 0.5 * (1.0 + stretched.z);
    t.y = mix(sqrt(max(1.0 - t.x * t.x, 0.0)), t.y, s);
    vec3 n = t.x * across + t.y * along + sqrt(max(1.0 - dot(t, t), 0.0)) * stretched;
    return normalize(vec3(alpha * n.xy, max(n.z, 1e-6)));
}

// Sample weight: Fresnel times G2 / G1, the Smith terms left after sampling visible normals.
float reflected_fraction(surface s, float v_h, float n_v, float n_l, float alpha)
{
    vec3 fresnel = specular_fresnel(s, v_h);
    vec2 squared = vec2(n_v, n_l) * vec2(n_v, n_l);
    vec2 hidden = 0.5 * (sqrt(1.0 + alpha * alpha * (1.0 - squared) / max(squared, 1e-8)) - 1.0);
    return luminance(fresnel) * (1.0 + hidden.x) / (1.0 + hidden.x + hidden.y);
}

void main()
{
    uint tile = tiles[gl_WorkGroupID.x];
    uvec2 first = uvec2(tile & 0xffffu, tile >> 16) * GROUP_EDGE +
                  gl_LocalInvocationID.xy * uint(GATHER_STEP);
    // Pixels of the square that need specular rays take turns.
    uint picture = uint(voxels.sample_count) - 1u;
    bool wanted = false;
    uvec2 pixel = first;
    surface s;
    uint i = 0u;
    do {
        uint turn = (i + picture) % uint(GATHER_STEP * GATHER_STEP);
        pixel = first + uvec2(turn % uint(GATHER_STEP), turn / uint(GATHER_STEP));
        if (any(greaterThanEqual(pixel, frame.render_size)))
            continue;
        s = gbuffer_load(pixel);
        wanted = s.shading < SHADE_UNLIT && needs_specular_trace(s);
    } while (++i < uint(GATHER_STEP * GATHER_STEP) && !wanted);
    if (!wanted)
        return;
    uvec2 texel = first / uint(GATHER_STEP);
    uint at = accumulation_index(PLANE_SPECULAR, texel);
    vec4 sum = picture == 0u ? vec4(0.0) : former_sum(at);
    float alpha = alpha_of(s);
    mat3 axes = frame_about(s.normal);
    vec3 view = s.view * axes;
    view = normalize(vec3(view.xy, max(view.z, 1e-3)));
    vec2 spread =
        vec2(accumulation_spacing_m(s), length(frame.ray_dx) * float(GATHER_STEP) + 0.25 * alpha);
    vec3 u = ray_numbers(texel, picture);
    vec3 facet = sample_visible_normal(view, alpha, u.xy);
    vec3 direction = axes * reflect(-view, facet);
    if (dot(direction, s.geometric_normal) > 0.0 && dot(direction, s.normal) > 0.0) {
        float fraction =
            reflected_fraction(s, dot(view, facet), view.z, dot(direction, s.normal), alpha);
        ray_light found =
            trace_radiance(offset_ray_origin(s.position, s.geometric_normal), normalize(direction),
                           u.z, spread, s.roughness, vec2(pixel));
        sum += fraction * vec4(found.radiance, 1.0);
    }
    accumulated[at] = sum;
}
