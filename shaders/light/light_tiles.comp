// Light culling: a bit mask per tile of LIGHT_TILE_EDGE^2 pixels, so there is no limit of lights
// per tile and no dependence on timing. In: depth, lights. Out: masks. Tests each light's sphere
// against the tile's frustum between its nearest and farthest depth (Olsson and Assarsson 2011,
// "Tiled Shading").
#include "lib/light_table.glsl"

layout(local_size_x = LINEAR_GROUP) in;

layout(binding = UNIT_DEPTH) uniform sampler2D depth_texture;

layout(std430, binding = BIND_LIGHT_MASKS) writeonly buffer light_mask_storage
{
    uint light_masks[];
};

shared uint nearest_bits;
shared uint farthest_bits;

// Depths are positive, so their bits compare like integers.
void reduce_depths(uvec2 tile)
{
    if (gl_LocalInvocationIndex == 0u) {
        nearest_bits = 0u;
        farthest_bits = 0xffffffffu;
    }
    barrier();
    uint nearest = 0u;
    uint farthest = 0xffffffffu;
    for (uint i = gl_LocalInvocationIndex; i < LIGHT_TILE_EDGE * LIGHT_TILE_EDGE;
         i += LINEAR_GROUP) {
        uvec2 pixel = tile * LIGHT_TILE_EDGE + uvec2(i % LIGHT_TILE_EDGE, i / LIGHT_TILE_EDGE);
        if (any(greaterThanEqual(pixel, frame.render_size)))
            continue;
        float depth = texelFetch(depth_texture, ivec2(pixel), 0).r;
        if (depth > 0.0) {
            nearest = max(nearest, floatBitsToUint(depth));
            farthest = min(farthest, floatBitsToUint(depth));
        }
    }
    atomicMax(nearest_bits, nearest);
    atomicMin(farthest_bits, farthest);
    barrier();
}

// Distances of the light's centre from the tile's four side planes, all through the eye.
bool sphere_in_tile(vec3 center, float radius, vec3 planes[4], float near_distance,
                    float far_distance)
{
    for (int i = 0; i < 4; i++)
        if (dot(planes[i], center) > radius)
            return false;
    float along = dot(frame.forward, center);
    return along + radius >= near_distance && along - radius <= far_distance;
}

void main()
{
    uvec2 tile = gl_WorkGroupID.xy;
    reduce_depths(tile);
    bool empty = nearest_bits == 0u;
#if TRANSPARENCY
    // Transparent layers may lie anywhere in front of the opaque depth.
    float near_distance = 0.0;
    float far_distance = 3.0e38;
    empty = false;
#else
    float near_distance = view_distance(uintBitsToFloat(max(nearest_bits, 1u)));
    float far_distance = view_distance(uintBitsToFloat(max(farthest_bits, 1u)));
#endif
    vec2 low = vec2(tile * LIGHT_TILE_EDGE) - 0.5;
    vec2 high = low + float(LIGHT_TILE_EDGE);
    vec3 corners[4] = {ray_direction(low), ray_direction(vec2(high.x, low.y)), ray_direction(high),
                       ray_direction(vec2(low.x, high.y))};
    vec3 planes[4];
    for (int i = 0; i < 4; i++) {
        planes[i] = normalize(cross(corners[i], corners[(i + 1) & 3]));
        // Outward: away from the opposite corner.
        if (dot(planes[i], corners[(i + 2) & 3]) > 0.0)
            planes[i] = -planes[i];
    }
    uint words = frame.light_mask_words;
    uint tile_index = tile.y * frame.tile_count.x + tile.x;
    for (uint word = gl_LocalInvocationIndex; word < words; word += LINEAR_GROUP) {
        uint mask = 0u;
        uint end = empty ? 0u : min(frame.light_count - word * 32u, 32u);
        uint bit = 0u;
        if (bit < end) {
            do {
                uint index = word * 32u + bit;
                light_block light = load_light(index);
                bool unlimited = light.type == LIGHT_DIRECTIONAL || light.range_m <= 0.0;
                if (unlimited || sphere_in_tile(light.position - frame.eye, light.range_m, planes,
                                                near_distance, far_distance))
                    mask |= 1u << bit;
            } while (++bit < end);
        }
        light_masks[tile_index * words + word] = mask;
    }
}
