// Closest hit against the BVH, shaded; the environment on a miss. LIT_HITS 1: hits are lit by each
// light; 0: from the voxels around them.
#define CONE_SMOOTH 0
#include "lib/geometry.glsl"
#include "lib/lighting.glsl"
#include "lib/environment.glsl"
#include "lib/cache_lookup.glsl"
#include "lib/bvh.glsl"

struct ray_light {
    vec3 radiance;    // cd/m^2
    float distance_m; // 1e30 on a miss
};

// Below this optical depth across a voxel, reads the next coarser level.
const float HIT_DEPTH = 0.1;

// Radiance / scale of the surfaces at a position that face a ray, from the voxels.
vec3 voxel_light_at(vec3 world, vec3 direction)
{
    vec3 position = voxel_position(world);
    uint level = 0u;
    bool outside;
    do {
        outside = inside_level(level, position) < 0.0;
        level += outside ? 1u : 0u;
    } while (outside && level < voxels.level_count);
    vec4 value = vec4(0.0);
    if (level < voxels.level_count) {
        do {
            value = sample_level(level, position, direction);
        } while (++level < voxels.level_count && value.a < HIT_DEPTH);
    }
    return value.a > 1e-6 ? value.rgb / value.a : vec3(0.0);
}

// Fraction of irradiance / pi reflected towards the viewer, diffuse and specular.
vec3 whole_reflectance(surface s)
{
    float n_v = clamp(dot(s.normal, s.view), 0.0, 1.0);
    vec2 scale_bias = environment_brdf(s.roughness, n_v);
    vec3 f0 = mix(s.f0, s.base_color, s.metallic);
    return s.base_color * ((1.0 - s.metallic) * mean_diffuse_fraction(s, n_v)) + f0 * scale_bias.x +
           mix(s.f90, 1.0, s.metallic) * scale_bias.y;
}

// Radiance of a hit towards the ray's origin. `spread`: distance in m between neighbouring pixels'
// rays at the hit, over the hit distance.
vec3 shade_hit(bvh_hit hit, uint flags, vec3 origin, vec3 direction, float spread,
               float min_roughness, vec2 pixel)
{
    uint at = hit.triangle * BVH_TRIANGLE_TEXELS;
    uint id = bvh_triangle_texel(at).w;
    mat3 axes = frame_about(direction);
    transparent_layer through;
    surface s = load_surface(
        id,
        camera_ray(origin + frame.bvh_origin, direction, axes[0] * spread, axes[1] * spread, pixel),
        through);
    // Spread rays rarely hit highlights of smooth surfaces: widens lobes to the ray's own
    // (Kaplanyan and Dachsbacher 2013, "Path Space Regularization").
    s.roughness = max(s.roughness, min_roughness);
    vec3 sum = (flags & BVH_LIT_DIRECTLY) != 0u ? vec3(0.0) : s.emission;
    if (s.shading >= SHADE_UNLIT) // unlit materials emit no light
        return vec3(0.0);
#if PUNCTUAL_LIGHTS || AREA_LIGHTS
    sum += direct_light(s, uvec2(0u));
#endif
#if MULTI_BOUNCE
    vec3 light = cached_irradiance(s.position, s.geometric_normal).rgb;
    sum += whole_reflectance(s) * light * voxels.radiance_scale;
#endif
    return sum;
}

// `origin` is relative to frame.bvh_origin, `direction` unit, `chance` uniform in [0, 1). `spread`:
// distance in m between neighbouring pixels' rays at the origin, and its growth per m. `roughness`
// is that of the lobe that the ray samples.
ray_light trace_radiance(vec3 origin, vec3 direction, float chance, vec2 spread, float roughness,
                         vec2 pixel)
{
    bvh_hit hit = closest_hit(origin, direction, 1e30, chance);
    ray_light found;
    found.distance_m = hit.distance;
    found.radiance = vec3(0.0);
    if (hit.triangle != BVH_LEAF) {
        uint at = hit.triangle * BVH_TRIANGLE_TEXELS;
        uvec4 edge_b = bvh_triangle_texel(at + 1u);
        uvec4 edge_c = bvh_triangle_texel(at + 2u);
        vec3 face = cross(uintBitsToFloat(edge_b.xyz), uintBitsToFloat(edge_c.xyz));
        if ((edge_c.w & BVH_ONE_SIDED) != 0u && dot(face, direction) > 0.0)
            return found;
#if LIT_HITS
        found.radiance = shade_hit(hit, edge_c.w, origin, direction,
                                   spread.x / max(hit.distance, 1e-6) + spread.y, roughness, pixel);
#else
        vec3 world = origin + frame.bvh_origin + hit.distance * direction;
        found.radiance = voxel_light_at(world, direction) * voxels.radiance_scale;
#endif
    }
#if ENVIRONMENT_LIGHT
    else
        found.radiance = environment_specular(direction, 0.5 * roughness);
#endif
    return found;
}
