// Rays against the scene's triangles. Their layout is told in shared/bvh.h.
#include "lib/frame.glsl"
#include "shared/bvh.h"

layout(binding = UNIT_TREE_NODES) uniform usampler2D tree_nodes;
layout(binding = UNIT_TREE_TRIANGLES) uniform usampler2D tree_triangles;

struct tree_hit {
    float distance; // in units of the direction's length
    uint triangle;
    vec2 weights; // of the second and third corner
};

const uint TREE_ROW_MASK = (1u << TREE_ROW_BITS) - 1u;
const uint TREE_COUNT_MASK = (1u << TREE_COUNT_BITS) - 1u;

uvec4 tree_node_texel(uint at)
{
    return texelFetch(tree_nodes, ivec2(at & TREE_ROW_MASK, at >> TREE_ROW_BITS), 0);
}

uvec4 tree_triangle_texel(uint at)
{
    return texelFetch(tree_triangles, ivec2(at & TREE_ROW_MASK, at >> TREE_ROW_BITS), 0);
}

// Where rays start that leave a surface: off it by what rounding may have moved it.
vec3 tree_origin(vec3 world, vec3 geometric_normal)
{
    float offset = frame.ray_min_offset_m + 4e-5 * length(world - frame.eye);
    return world - frame.bvh_origin + offset * geometric_normal;
}

// Interval of a ray in a box; empty where x > y.
vec2 cross_box(vec3 lower, vec3 upper, vec3 origin, vec3 inverse)
{
    vec3 a = (lower - origin) * inverse;
    vec3 b = (upper - origin) * inverse;
    vec3 nearer = min(a, b);
    vec3 farther = max(a, b);
    return vec2(max(max(nearer.x, nearer.y), max(nearer.z, 0.0)),
                min(min(farther.x, farther.y), farther.z));
}

// Moller and Trumbore 1997; both sides. Of masked triangles (opacity below 1) so many stop a ray as
// are opaque on average: `chance` is uniform in [0, 1).
void cross_triangle(uint number, vec3 origin, vec3 direction, float chance, inout tree_hit hit)
{
    uint at = number * TREE_TRIANGLE_TEXELS;
    uvec4 second = tree_triangle_texel(at + 1u);
    vec3 corner = uintBitsToFloat(tree_triangle_texel(at).xyz);
    vec3 edge_b = uintBitsToFloat(second.xyz);
    vec3 edge_c = uintBitsToFloat(tree_triangle_texel(at + 2u).xyz);
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

// The nearest triangle within `reach`; hit.triangle is TREE_LEAF where there is none. `origin` is
// relative to frame.bvh_origin.
tree_hit find_nearest(vec3 origin, vec3 direction, float reach, float chance)
{
    tree_hit hit;
    hit.distance = reach;
    hit.triangle = TREE_LEAF;
    hit.weights = vec2(0.0);
    vec3 safe = mix(vec3(1e-20), abs(direction), greaterThan(abs(direction), vec3(1e-20)));
    vec3 inverse = mix(vec3(1.0), vec3(-1.0), lessThan(direction, vec3(0.0))) / safe;
    uint stack[TREE_MAX_DEPTH];
    uint depth = 0u;
    uint current = 0u;
    for (;;) {
        // Down to a leaf, or to the end of the stack, an empty leaf.
        while (current < TREE_LEAF) {
            uint at = current * TREE_NODE_TEXELS;
            uvec4 lower0 = tree_node_texel(at);
            uvec4 upper0 = tree_node_texel(at + 1u);
            uvec4 lower1 = tree_node_texel(at + 2u);
            uvec4 upper1 = tree_node_texel(at + 3u);
            vec2 span0 = cross_box(uintBitsToFloat(lower0.xyz), uintBitsToFloat(upper0.xyz), origin,
                                   inverse);
            vec2 span1 = cross_box(uintBitsToFloat(lower1.xyz), uintBitsToFloat(upper1.xyz), origin,
                                   inverse);
            bool met0 = span0.x <= min(span0.y * 1.000001, hit.distance);
            bool met1 = span1.x <= min(span1.y * 1.000001, hit.distance);
            bool swapped = span1.x < span0.x;
            uint nearer = met0 && !(met1 && swapped) ? lower0.w : lower1.w;
            uint farther = swapped ? lower0.w : lower1.w;
            if (met0 && met1)
                stack[depth++] = farther;
            current = nearer;
            if (!met0 && !met1)
                current = depth > 0u ? stack[--depth] : TREE_LEAF;
        }
        uint number = (current & ~TREE_LEAF) >> TREE_COUNT_BITS;
        uint end = number + (current & TREE_COUNT_MASK);
        for (; number < end; number++)
            cross_triangle(number, origin, direction, chance, hit);
        if (depth == 0u)
            return hit;
        current = stack[--depth];
    }
}
