// Gathers irradiance at pixels (every GATHER_STEP-th) by rays against the real geometry. In: G-buffer,
// tree of triangles, radiance texture. Out: sums over the frames in which nothing moved.
//
// Pixels of a square of 4x4 share one low-discrepancy sequence (Keller and Heidrich 2001, "Interleaved
// Sampling"), so that the filter that follows averages all of it.
#define CONE_SMOOTH 0
#include "lib/gbuffer.glsl"
#include "lib/triangle_tree.glsl"
#include "lib/hit_light.glsl"

layout(local_size_x = GROUP_EDGE, local_size_y = GROUP_EDGE) in;

layout(std430, binding = BIND_INDIRECT) buffer indirect_storage
{
    vec4 gathered[]; // sums; then the same filtered
};

// Place of a pixel in the square's order: neighbours lie far apart in it (Bayer 1973).
uint interleaved_order(uvec2 p)
{
    uint low = ((p.x ^ p.y) & 1u) * 2u + (p.y & 1u);
    uint high = (((p.x ^ p.y) >> 1) & 1u) * 2u + ((p.y >> 1) & 1u);
    return low * 4u + high;
}

// A point of the additive recurrence on the generalised golden ratio (Roberts 2018, "The Unreasonable
// Effectiveness of Quasirandom Sequences"), and a third number for what else is left to chance.
vec3 sequence_point(uint i)
{
    uvec3 bits = uvec3(0xc13fa9a9u, 0x91e10da5u, 0x9e3779b9u) * (i + 1u);
    return vec3(bits >> 8) * (1.0 / 16777216.0);
}

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
    for (uint i = 0u; i < uint(RAYS); i++) {
        vec3 u = sequence_point((picture * uint(RAYS) + i) * 16u + interleaved_order(place));
        float radius = sqrt(u.x);
        vec2 disc = radius * vec2(cos(2.0 * PI * u.y), sin(2.0 * PI * u.y));
        vec3 direction = axes * vec3(disc, sqrt(max(1.0 - u.x, 0.0)));
        if (dot(direction, s.geometric_normal) <= 0.0)
            continue;
        sum += light_along(origin, direction, u.z) * (1.0 / float(RAYS));
    }
    gathered[at] = sum;
}
