// Gathers what glossy surfaces mirror at pixels (every GATHER_STEP-th) by rays against the real
// geometry, which is shaded where they meet it: LIT_HITS 1 by each lamp, 0 as the voxels are lit. In
// the tiles that hold any gloss, one group each. In: tiles, G-buffer, tree of triangles, materials,
// lights, shadow maps, irradiance. Out: sums over the frames in which nothing moved.
#define CONE_SMOOTH 0
#define CELLS_ACCESS readonly
#include "lib/gbuffer.glsl"
#include "lib/geometry.glsl"
#include "lib/lighting.glsl"
#include "lib/environment.glsl"
#include "lib/gloss_rule.glsl"
#include "lib/hit_light.glsl"
#include "lib/irradiance_read.glsl"
#include "lib/ray_sequence.glsl"

layout(local_size_x = GROUP_EDGE / GATHER_STEP, local_size_y = GROUP_EDGE / GATHER_STEP) in;

layout(std430, binding = BIND_TILES) readonly buffer tile_storage
{
    uvec4 tile_arguments;
    uint tiles[];
};

layout(std430, binding = BIND_INDIRECT) buffer indirect_storage
{
    vec4 gathered[]; // the last third: sums of what lobes mirror; w: their number
};

// A microfacet normal that the viewer sees, about +Z, of a surface of GGX roughness alpha (Heitz 2018,
// "Sampling the GGX Distribution of Visible Normals").
vec3 sample_visible_normal(vec3 view, float alpha, vec2 u)
{
    vec3 stretched = normalize(vec3(alpha * view.xy, view.z));
    mat3 axes = frame_about(stretched);
    float radius = sqrt(u.x);
    vec2 t = radius * vec2(cos(2.0 * PI * u.y), sin(2.0 * PI * u.y));
    // frame_about() turns about Z as it likes; the halves of the disk are told by the normal's side.
    vec3 across = safe_normalize(vec3(-stretched.y, stretched.x, 0.0), axes[0]);
    vec3 along = cross(stretched, across);
    float s = 0.5 * (1.0 + stretched.z);
    t.y = mix(sqrt(max(1.0 - t.x * t.x, 0.0)), t.y, s);
    vec3 n = t.x * across + t.y * along + sqrt(max(1.0 - dot(t, t), 0.0)) * stretched;
    return normalize(vec3(alpha * n.xy, max(n.z, 1e-6)));
}

// Radiance in cd/m^2 that a surface sends back along the ray that met it.
vec3 hit_radiance(tree_hit hit, vec3 origin, vec3 direction, float spread, vec2 pixel)
{
    uint at = hit.triangle * TREE_TRIANGLE_TEXELS;
    uint id = tree_triangle_texel(at).w;
    bool lit_directly = (tree_triangle_texel(at + 2u).w & TREE_LIT_DIRECTLY) != 0u;
    mat3 axes = frame_about(direction);
    layer through;
    surface s = load_surface(id, sight(origin + frame.tree.xyz, direction, axes[0] * spread,
                                       axes[1] * spread, pixel), through);
    vec3 emitted = lit_directly ? vec3(0.0) : s.emission;
    if (s.shading >= SHADE_UNLIT)
        return emitted;
#if LIT_HITS
    vec3 sum = emitted;
#if PUNCTUAL_LIGHTS || AREA_LIGHTS
    sum += direct_light(s, uvec2(0u));
#endif
    // Light that has been reflected already reaches matte and glossy parts alike as irradiance.
    vec2 scale_bias = environment_brdf(s.roughness, clamp(dot(s.normal, s.view), 0.0, 1.0));
    vec3 layered = s.f0 * scale_bias.x + s.f90 * scale_bias.y;
    float kept = 1.0 - max(layered.r, max(layered.g, layered.b));
    vec3 f0 = mix(s.f0, s.base_color, s.metallic);
    vec3 reflectance = s.base_color * ((1.0 - s.metallic) * kept) + f0 * scale_bias.x +
                       mix(s.f90, 1.0, s.metallic) * scale_bias.y;
    vec3 light = cached_irradiance(s.position, s.geometric_normal).rgb;
    return sum + reflectance * light * (s.occlusion * voxels.anchor.w * voxels.light.y);
#else
    return voxel_light_at(s.position, direction) * voxels.anchor.w;
#endif
}

void main()
{
    uint tile = tiles[gl_WorkGroupID.x];
    uvec2 first = uvec2(tile & 0xffffu, tile >> 16) * GROUP_EDGE +
                  gl_LocalInvocationID.xy * uint(GATHER_STEP);
    // The first pixel of the square whose gloss wants rays stands for all.
    bool wanted = false;
    uvec2 pixel = first;
    surface s;
    for (uint i = 0u; i < uint(GATHER_STEP * GATHER_STEP) && !wanted; i++) {
        pixel = first + uvec2(i % uint(GATHER_STEP), i / uint(GATHER_STEP));
        if (any(greaterThanEqual(pixel, frame.size.xy)))
            continue;
        s = gbuffer_load(pixel);
        wanted = s.shading < SHADE_UNLIT && deserves_cone(s);
    }
    if (!wanted)
        return;
    uvec2 size = (frame.size.xy + uint(GATHER_STEP) - 1u) / uint(GATHER_STEP);
    uvec2 place = first / uint(GATHER_STEP);
    uint at = 2u * size.x * size.y + place.y * size.x + place.x;
    uint picture = uint(voxels.settle.y) - 1u;
    vec4 sum = picture == 0u ? vec4(0.0) : gathered[at];
    float alpha = alpha_of(s);
    mat3 axes = frame_about(s.normal);
    vec3 view = s.view * axes;
    view.z = max(view.z, 1e-3);
    vec3 origin = tree_origin(s.position, s.geometric_normal);
    float pixel_spread = length(frame.ray_dx.xyz) * float(GATHER_STEP);
    float eye_m = length(s.position - frame.eye.xyz);
    for (uint i = 0u; i < uint(GATHER_RAYS_PER_PICTURE); i++) {
        vec3 u = sequence_point((picture * uint(GATHER_RAYS_PER_PICTURE) + i) * 16u +
                                interleaved_order(place));
        vec3 facet = sample_visible_normal(normalize(view), alpha, u.xy);
        vec3 direction = axes * reflect(-normalize(view), facet);
        if (dot(direction, s.geometric_normal) <= 0.0 || dot(direction, s.normal) <= 0.0)
            continue;
        direction = normalize(direction);
        tree_hit hit = find_nearest(origin, direction, 1e30, u.z);
        vec3 light = vec3(0.0);
        if (hit.triangle != TREE_LEAF) {
            float spread = pixel_spread * (1.0 + eye_m / max(hit.distance, 1e-6)) + 0.25 * alpha;
            light = hit_radiance(hit, origin, direction, spread, vec2(pixel));
        }
#if ENVIRONMENT_LIGHT
        else
            light = environment_specular(direction, 0.5 * s.roughness);
#endif
        sum += vec4(light, 1.0);
    }
    gathered[at] = sum;
}
