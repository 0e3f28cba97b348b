// Gathers irradiance at pixels (every GATHER_STEP-th) by rays against the real geometry. In: G-buffer,
// tree of triangles, radiance texture. Out: sums over the frames in which nothing moved.
#define CONE_SMOOTH 0
#include "lib/gbuffer.glsl"
#include "lib/triangle_tree.glsl"
#include "lib/hit_light.glsl"
#include "lib/ray_sequence.glsl"

layout(local_size_x = GROUP_EDGE, local_size_y = GROUP_EDGE) in;

layout(std430, binding = BIND_INDIRECT) buffer indirect_storage
{
    vec4 gathered[]; // sums; then the same filtered
};

void main()
{
    uvec2 place = gl_GlobalInvocationID.xy;
    uvec2 size = (frame.size.xy + uint(GATHER_STEP) - 1u) / uint(GATHER_STEP);
    if (any(greaterThanEqual(place, size)))
        return;
    surface s = gbuffer_load(place * uint(GATHER_STEP));
    if (s.shading >= SHADE_UNLIT)
        return;
    uint at = place.y * size.x + place.x;
    uint picture = uint(voxels.settle.y) - 1u;
    mat3 axes = frame_about(s.normal);
    vec3 origin = tree_origin(s.position, s.geometric_normal);
    vec4 sum = picture == 0u ? vec4(0.0) : gathered[at];
    for (uint i = 0u; i < uint(GATHER_RAYS_PER_PICTURE); i++) {
        vec3 u = sequence_point((picture * uint(GATHER_RAYS_PER_PICTURE) + i) * 16u + interleaved_order(place));
        float radius = sqrt(u.x);
        vec2 disc = radius * vec2(cos(2.0 * PI * u.y), sin(2.0 * PI * u.y));
        vec3 direction = axes * vec3(disc, sqrt(max(1.0 - u.x, 0.0)));
        if (dot(direction, s.geometric_normal) <= 0.0)
            continue;
        sum += light_along(origin, direction, u.z) * (1.0 / float(GATHER_RAYS_PER_PICTURE));
    }
    gathered[at] = sum;
}
