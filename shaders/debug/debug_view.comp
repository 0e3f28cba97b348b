// Debug views of intermediate results. In: G-buffer, ids, light masks, shadow views. Out: display
// values, shown without exposure and tone curve.
#include "lib/gbuffer.glsl"
#include "lib/display.glsl"
#include "lib/radiance_buffer.glsl"
#include "shared/shadow_view_block.h"
#if SINGLE_VIEW_SHADOWS
#include "lib/shadow.glsl"
#endif

layout(local_size_x = PIXEL_GROUP_WIDTH, local_size_y = PIXEL_GROUP_HEIGHT) in;

layout(binding = UNIT_IDS) uniform usampler2D ids;

#if LIGHT_TILES
layout(binding = UNIT_LIGHT_MASKS) uniform usamplerBuffer light_masks;
#endif

const uint VIEW_ALBEDO = 2u;
const uint VIEW_NORMAL = 3u;
const uint VIEW_ROUGHNESS = 4u;
const uint VIEW_METALLIC = 5u;
const uint VIEW_EMISSION = 6u;
const uint VIEW_DEPTH = 7u;
const uint VIEW_IDS = 8u;
const uint VIEW_LIGHTS_PER_TILE = 9u;
const uint VIEW_SHADOW_CASCADES = 10u;

// A distinct colour for every number (hash of Jarzynski and Olano 2020, "pcg").
vec3 number_color(uint number)
{
    uint state = number * 747796405u + 2891336453u;
    uint word = ((state >> ((state >> 28) + 4u)) ^ state) * 277803737u;
    word = (word >> 22) ^ word;
    return vec3(word & 255u, (word >> 8) & 255u, (word >> 16) & 255u) / 255.0 * 0.8 + 0.2;
}

// Black, blue, green, yellow, red for 0 .. 1.
vec3 heat(float x)
{
    return clamp(vec3(2.0 * x - 0.7, 2.0 * x * (x < 0.75 ? 1.0 : 4.0 - 4.0 * x),
                      x < 0.5 ? 4.0 * x * (1.0 - 2.0 * x) + x * 0.5 : 0.0),
                 0.0, 1.0);
}

uint lights_of_tile(uvec2 pixel)
{
#if LIGHT_TILES
    uint tile = (pixel.y / LIGHT_TILE_EDGE) * frame.tile_count.x + pixel.x / LIGHT_TILE_EDGE;
    uint count = 0u;
    for (uint word = 0u; word < frame.light_mask_words; word++)
        count +=
            uint(bitCount(texelFetch(light_masks, int(tile * frame.light_mask_words + word)).x));
    return count;
#else
    return frame.light_count;
#endif
}

vec3 cascade_color(surface s)
{
#if SINGLE_VIEW_SHADOWS
    if (frame.cascade_count == 0u)
        return vec3(0.35 + 0.65 * clamp(dot(s.normal, s.view), 0.0, 1.0));
    uint view_number = frame.sun_shadow_view;
    shadow_lookup at =
        project_to_shadow(view_number, s.position, s.geometric_normal, s.geometric_normal);
    uint cascade = refine_by_cascade(at);
    const vec3 colors[4] = {vec3(1.0, 0.35, 0.3), vec3(0.4, 1.0, 0.4), vec3(0.4, 0.55, 1.0),
                            vec3(1.0, 0.9, 0.4)};
    vec3 tint = cascade < frame.cascade_count ? colors[cascade] : colors[3];
    return tint * (0.35 + 0.65 * clamp(dot(s.normal, s.view), 0.0, 1.0));
#else
    return vec3(0.35 + 0.65 * clamp(dot(s.normal, s.view), 0.0, 1.0));
#endif
}

vec3 debug_color(uvec2 pixel, surface s)
{
    switch (frame.debug_view) {
    case VIEW_ALBEDO:
        return transfer(s.base_color);
    case VIEW_NORMAL:
        return s.normal * 0.5 + 0.5;
    case VIEW_ROUGHNESS:
        return vec3(s.roughness);
    case VIEW_METALLIC:
        return vec3(s.metallic);
    case VIEW_EMISSION:
        return transfer(s.emission / (1.0 + s.emission));
    case VIEW_DEPTH: {
        float d = view_distance(texelFetch(depth_texture, ivec2(pixel), 0).r);
        // Near white, far black, half at a third of the scene's diagonal.
        return vec3(1.0 / (1.0 + d / (0.33 * frame.scene_diagonal_m)));
    }
    case VIEW_IDS:
        return number_color(texelFetch(ids, ivec2(pixel), 0).r);
    case VIEW_SHADOW_CASCADES:
        return cascade_color(s);
    }
    return vec3(0.0);
}

void main()
{
    uvec2 pixel = gl_GlobalInvocationID.xy;
    if (any(greaterThanEqual(pixel, frame.render_size)))
        return;
    surface s = gbuffer_load(pixel);
    vec3 color = vec3(0.0);
    if (frame.debug_view == VIEW_LIGHTS_PER_TILE)
        color = heat(float(lights_of_tile(pixel)) / 32.0);
    else if (s.shading != SHADE_BACKGROUND)
        color = debug_color(pixel, s);
    radiance[pixel_index(pixel)] = vec4(color, 1.0);
}
