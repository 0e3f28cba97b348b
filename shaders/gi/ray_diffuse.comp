// Gathers irradiance at every GATHER_STEP-th pixel, one ray per frame against the triangles. In:
// G-buffer, BVH, materials, lights, shadow maps, irradiance cache. Out: sums over the frames in
// which nothing moved.
#include "lib/ray_accumulation.glsl"
#include "lib/gbuffer.glsl"
#include "lib/hit_shading.glsl"
#include "lib/ray_sequence.glsl"

layout(local_size_x = PIXEL_GROUP_WIDTH, local_size_y = PIXEL_GROUP_HEIGHT) in;

// Angle in radians over which textures are filtered at hits.
const float RAY_SPREAD = 0.03;
// Roughness of a lobe about as wide as the solid angle of one hemisphere ray.
const float RAY_ROUGHNESS = 0.6;

void main()
{
    uvec2 texel = gl_GlobalInvocationID.xy;
    if (any(greaterThanEqual(texel, accumulation_size())))
        return;
    surface s = gbuffer_load(texel * uint(GATHER_STEP));
    if (s.shading >= SHADE_UNLIT)
        return;
    uint picture = uint(voxels.sample_count) - 1u;
    vec3 u = ray_numbers(texel, picture);
    vec2 disc = sqrt(u.x) * vec2(cos(2.0 * PI * u.y), sin(2.0 * PI * u.y));
    vec3 direction = frame_about(s.normal) * vec3(disc, sqrt(max(1.0 - u.x, 0.0)));
    vec4 light = vec4(0.0);
    // A normal map can turn a ray into the surface.
    if (dot(direction, s.geometric_normal) > 0.0) {
        ray_light found =
            trace_radiance(offset_ray_origin(s.position, s.geometric_normal), direction, u.z,
                           vec2(0.0, RAY_SPREAD), RAY_ROUGHNESS, vec2(texel));
        light = vec4(found.radiance / voxels.radiance_scale,
                     min(found.distance_m / voxels.ao_radius_m, 1.0));
    }
    uint at = accumulation_index(PLANE_DIFFUSE, texel);
    accumulated[at] = (picture == 0u ? vec4(0.0) : former_sum(at)) + light;
}
