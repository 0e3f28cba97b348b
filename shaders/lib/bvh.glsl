// Ray casts against the scene's triangles. Layout: shared/bvh.h.
#include "lib/frame.glsl"
#include "shared/bvh.h"

layout(binding = UNIT_BVH_NODES) uniform usamplerBuffer bvh_nodes;
layout(binding = UNIT_BVH_TRIANGLES) uniform usamplerBuffer bvh_triangles;

struct bvh_hit {
    float distance; // in units of the direction's length
    uint triangle;
    vec2 weights; // barycentric, of the second and third corner
};

const uint BVH_COUNT_MASK = (1u << BVH_COUNT_BITS) - 1u;

uvec4 bvh_node_texel(uint at)
{
    return texelFetch(bvh_nodes, int(at));
}

uvec4 bvh_triangle_texel(uint at)
{
    return texelFetch(bvh_triangles, int(at));
}

// Origin of rays that leave a surface: offset by what rounding may have moved it.
vec3 offset_ray_origin(vec3 world, vec3 geometric_normal)
{
    float offset = frame.ray_min_offset_m + 4e-5 * length(world - frame.eye);
    return world - frame.bvh_origin + offset * geometric_normal;
}

// Interval of a ray in a box; empty if x > y.
vec2 cross_box(vec3 lower, vec3 upper, vec3 origin, vec3 inverse)
{
    vec3 a = (lower - origin) * inverse;
    vec3 b = (upper - origin) * inverse;
    vec3 nearer = min(a, b);
    vec3 farther = max(a, b);
    return vec2(max(max(nearer.x, nearer.y), max(nearer.z, 0.0)),
                min(min(farther.x, farther.y), farther.z));
}

// Moller and Trumbore 1997; two-sided. Masked triangles (opacity below 1) stop a fraction of the
// rays equal to their mean opacity: `chance` is uniform in [0, 1).
void cross_triangle(uint number, vec3 origin, vec3 direction, float chance, inout bvh_hit hit)
{
    uint at = number * BVH_TRIANGLE_TEXELS;
    uvec4 second = bvh_triangle_texel(at + 1u);
    vec3 corner = uintBitsToFloat(bvh_triangle_texel(at).xyz);
    vec3 edge_b = uintBitsToFloat(second.xyz);
    vec3 edge_c = uintBitsToFloat(bvh_triangle_texel(at + 2u).xyz);
    vec3 across = cross(direction, edge_c);
    float determinant = dot(edge_b, across);
    float inverse = 1.0 / (determinant != 0.0 ? determinant : 1.0);
    vec3 from = origin - corner;
    float b = dot(from, across) * inverse;
    vec3 turned = cross(from, edge_b);
    float c = dot(direction, turned) * inverse;
    float t = dot(edge_c, turned) * inverse;
    bool met =
        determinant != 0.0 && b >= 0.0 && c >= 0.0 && b + c <= 1.0 && t > 0.0 && t < hit.distance;
#if ALPHA_MASK
    met = met && uintBitsToFloat(second.w) > fract(chance + float(number & 1023u) * 0.61803399);
#endif
    if (met) {
        hit.distance = t;
        hit.triangle = number;
        hit.weights = vec2(b, c);
    }
}

// Closest hit within `reach`; hit.triangle is BVH_LEAF on a miss. `origin` is relative to
// frame.bvh_origin.
bvh_hit closest_hit(vec3 origin, vec3 direction, float reach, float chance)
{
    bvh_hit hit;
    hit.distance = reach;
    hit.triangle = BVH_LEAF;
    hit.weights = vec2(0.0);
    vec3 safe = mix(vec3(1e-20), abs(direction), greaterThan(abs(direction), vec3(1e-20)));
    vec3 inverse = mix(vec3(1.0), vec3(-1.0), lessThan(direction, vec3(0.0))) / safe;
    uint stack[BVH_MAX_DEPTH];
    uint depth = 0u;
    uint current = 0u;
    for (;;) {
        // Descends to a leaf, or to the end of the stack, an empty leaf.
        if (current < BVH_LEAF) {
            do {
                uint at = current * BVH_NODE_TEXELS;
                uvec4 lower0 = bvh_node_texel(at);
                uvec4 upper0 = bvh_node_texel(at + 1u);
                uvec4 lower1 = bvh_node_texel(at + 2u);
                uvec4 upper1 = bvh_node_texel(at + 3u);
                vec2 span0 = cross_box(uintBitsToFloat(lower0.xyz), uintBitsToFloat(upper0.xyz),
                                       origin, inverse);
                vec2 span1 = cross_box(uintBitsToFloat(lower1.xyz), uintBitsToFloat(upper1.xyz),
                                       origin, inverse);
                bool met0 = span0.x <= min(span0.y * 1.000001, hit.distance);
                bool met1 = span1.x <= min(span1.y * 1.000001, hit.distance);
                bool swapped = span1.x < span0.x;
                uint nearer = met0 && !(met1 && swapped) ? lower0.w : lower1.w;
                uint farther = swapped ? lower0.w : lower1.w;
                if (met0 && met1)
                    stack[depth++] = farther;
                current = nearer;
                if (!met0 && !met1)
                    current = depth > 0u ? stack[--depth] : BVH_LEAF;
            } while (current < BVH_LEAF);
        }
        uint number = (current & ~BVH_LEAF) >> BVH_COUNT_BITS;
        uint end = number + (current & BVH_COUNT_MASK);
        if (number < end) {
            do {
                cross_triangle(number, origin, direction, chance, hit);
            } while (++number < end);
        }
        if (depth == 0u)
            return hit;
        current = stack[--depth];
    }
}
