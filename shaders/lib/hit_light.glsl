// What a ray against the real geometry sees: the light that voxels hold where it meets a triangle, or
// the environment.
#include "lib/cone.glsl"
#include "lib/environment.glsl"
#include "lib/triangle_tree.glsl"

// Roughness whose lobe is about as wide as the share of a hemisphere that a ray stands for.
const float RAY_ROUGHNESS = 0.2;
// Optical depth across a voxel from which its light counts; else the next coarser level is read.
const float HIT_DEPTH = 0.1;

// Radiance / scale of the surfaces at a place that face a ray.
vec3 voxel_light_at(vec3 world, vec3 direction)
{
    vec3 position = voxel_position(world);
    uint level = 0u;
    while (level < voxels.counts.x && inside_level(level, position) < 0.0)
        level++;
    vec4 value = vec4(0.0);
    for (; level < voxels.counts.x && value.a < HIT_DEPTH; level++)
        value = sample_level(level, position, direction);
    return value.a > 1e-6 ? value.rgb / value.a : vec3(0.0);
}

// Radiance / scale along a ray, and 1 less the occlusion by what is near. `origin` is relative to
// frame.tree, `direction` unit.
vec4 light_along(vec3 origin, vec3 direction, float chance)
{
    tree_hit hit = find_nearest(origin, direction, 1e30, chance);
    bool met = hit.triangle != TREE_LEAF;
    vec3 world = origin + frame.tree.xyz + (met ? hit.distance : 0.0) * direction;
    vec3 light = voxel_light_at(world, direction);
#if ENVIRONMENT_LIGHT
    vec3 sky = environment_specular(direction, RAY_ROUGHNESS) / voxels.anchor.w;
#else
    vec3 sky = vec3(0.0);
#endif
    float open = met ? min(hit.distance / voxels.light.x, 1.0) : 1.0;
    return vec4(met ? light : sky, open);
}
