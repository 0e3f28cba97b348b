// One cone as wide as a specular lobe of the given roughness.
#include "lib/cone.glsl"
#include "lib/environment.glsl"

// Half of all GGX microfacet normals lie within atan(alpha) of the mean; reflection doubles the
// angle, and most of the lobe's energy lies within slightly less.
float lobe_tangent(float roughness)
{
    float alpha = roughness * roughness;
    return max(1.2 * alpha, 0.01);
}

// Radiance in cd/m^2. `normal` offsets the origin from the surface, which may be thin.
vec3 trace_specular(vec3 position_world, vec3 normal, bool thin, vec3 direction, float roughness)
{
    vec3 origin = voxel_position(position_world);
    float voxel = finest_voxel(origin);
    cone c;
    c.origin =
        origin + normal * (cone_start(voxels.pixel_march.start_voxels, thin, normal) * voxel);
    c.direction = direction;
    c.tangent = lobe_tangent(roughness);
    c.step = min(voxels.pixel_march.step_diameters, 1.0);
    // Maximum diameter: a voxel of the coarsest level or mip, but at most four of the coarsest
    // level.
    c.widest =
        min(4.0 * voxels.cone_max_diameter_m, voxels.levels[voxels.level_count - 1u].voxel_edge_m);
    c.reach_m = 1e30;
    cone_light found = trace_cone(c, 1.0);
    vec3 light = found.light * voxels.radiance_scale;
#if ENVIRONMENT_LIGHT
    light += environment_specular(direction, roughness) * found.transmittance;
#endif
    return light;
}
