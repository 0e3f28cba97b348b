// Shadow-map look-ups: percentage-closer filtering (Reeves et al. 1987) over the hardware's 2x2
// comparison, with a normal offset against acne (Holbert 2011).
#include "lib/frame.glsl"
#include "shared/shadow_view_block.h"

layout(binding = UNIT_SHADOW_VIEWS) uniform usamplerBuffer shadow_views; // of shadow_view_block

vec4 shadow_view_floats(uint texel)
{
    return uintBitsToFloat(texelFetch(shadow_views, int(texel)));
}

// Layers of the scene's lights, then of the views' cascades.
layout(binding = UNIT_SHADOW_MAP) uniform sampler2DArrayShadow shadow_map;

#ifndef SHADOW_TAPS
#define SHADOW_TAPS frame.shadow_tap_count
#endif

const float PCF_RADIUS_TEXELS = 1.5;
// Rotation by the golden angle, pi (3 - sqrt 5), which spaces a Vogel disk evenly.
const mat2 GOLDEN_ROTATION = mat2(-0.7373688, 0.6754903, -0.6754903, -0.7373688);

// Mean of comparisons on a Vogel disk around `at`: uv, layer, reference depth.
float filtered_comparison(vec4 at)
{
    uint taps = SHADOW_TAPS;
    float texel = 1.0 / float(textureSize(shadow_map, 0).x);
    float lit = 0.0;
    float scale = taps > 1u ? PCF_RADIUS_TEXELS * texel * inversesqrt(float(taps)) : 0.0;
    vec2 direction = vec2(1.0, 0.0);
    uint i = 0u;
    do {
        vec2 offset = direction * (scale * sqrt(float(i) + 0.5));
        direction = GOLDEN_ROTATION * direction;
        lit += texture(shadow_map, at + vec4(offset, 0.0, 0.0));
    } while (++i < taps);
    return lit / float(taps);
}

// Normal offset in texels against acne: more at grazing light.
float offset_texels(vec3 normal, vec3 to_light)
{
    float cosine = clamp(dot(normal, to_light), 0.0, 1.0);
    return 0.1 + 0.2 * sqrt(1.0 - cosine * cosine);
}

bool is_inside(vec2 uv)
{
    // Reach of the normal offset and the filter.
    float margin = 5.0 / float(textureSize(shadow_map, 0).x);
    return all(greaterThan(uv, vec2(margin))) && all(lessThan(uv, vec2(1.0 - margin)));
}

#if SINGLE_VIEW_SHADOWS
// A position in a shadow view: uv, layer, reversed depth; how the normal offset moves it there; and
// whether the view contains it.
struct shadow_lookup {
    vec4 at;
    vec3 lift;
    bool inside;
};

// Position in the view of a spot or the sun.
shadow_lookup project_to_shadow(uint view_number, vec3 position, vec3 normal, vec3 to_light)
{
    uint record = 5u * view_number;
    mat4 clip_from_world = mat4(shadow_view_floats(record), shadow_view_floats(record + 1u),
                                shadow_view_floats(record + 2u), shadow_view_floats(record + 3u));
    uvec4 words = texelFetch(shadow_views, int(record + 4u));
    vec4 clip = clip_from_world * vec4(position, 1.0);
    bool perspective = words.y != 0u;
    float size = uintBitsToFloat(words.x) * (perspective ? max(clip.w, 0.0) : 1.0);
    vec4 lifted =
        clip + clip_from_world * vec4(normal * (size * offset_texels(normal, to_light)), 0.0);
    const vec3 uv_from_ndc = vec3(0.5, -0.5, 1.0);
    vec3 plain = clip.xyz / max(clip.w, 1e-20) * uv_from_ndc + vec3(0.5, 0.5, 0.0);
    vec3 moved = lifted.xyz / max(lifted.w, 1e-20) * uv_from_ndc + vec3(0.5, 0.5, 0.0);
    shadow_lookup lookup;
    lookup.at = vec4(plain.xy, float(view_number), plain.z);
    lookup.lift = moved - plain;
    lookup.inside = clip.w > 0.0 && is_inside(plain.xy);
    return lookup;
}

// Refines a position in the sun's map of the whole scene to the smallest cascade that contains it,
// where texels and the normal offset are smaller. All share the sun's axes, so a cascade is a scale
// and an offset. Returns its number, or frame.cascade_count.
uint refine_by_cascade(inout shadow_lookup lookup)
{
    uint found = frame.cascade_count;
    shadow_lookup from = lookup;
    uint i = frame.cascade_count;
    if (i == 0u)
        return found;
    do {
        i--;
        vec3 scale = frame.cascades[i].scale;
        vec3 at = from.at.xyw * scale + frame.cascades[i].offset;
        if (is_inside(at.xy)) {
            lookup.at = vec4(at.xy, frame.cascades[i].layer, at.z);
            lookup.lift = from.lift * (scale / scale.x);
            found = i;
        }
    } while (i > 0u);
    return found;
}

#endif

#if POINT_SHADOWS
// Position in a light's cube of six views, ordered as renderer/gpu_scene/lights.c does: uv, layer,
// depth.
vec4 project_to_cube(uint first_view, vec3 origin, vec3 position, vec3 normal, vec3 to_light)
{
    vec3 d = position - origin;
    vec3 size = abs(d);
    float major = max(size.x, max(size.y, size.z));
    float lift = major * (2.0 * SHADOW_FACE_MARGIN) / float(textureSize(shadow_map, 0).x);
    d += normal * (lift * offset_texels(normal, to_light));
    bool is_x = size.x >= size.y && size.x >= size.z;
    bool is_y = !is_x && size.y >= size.z;
    float along = is_x ? d.x : is_y ? d.y : d.z;
    float turn = along > 0.0 ? 1.0 : -1.0;
    float right = is_x ? turn * d.z : is_y ? turn * d.x : -turn * d.x;
    float up = is_y ? d.z : d.y;
    float face = (is_x ? 0.0 : is_y ? 2.0 : 4.0) + (along > 0.0 ? 0.0 : 1.0);
    float distance = max(abs(along), 1e-20);
    vec2 lookup = vec2(right, -up) / (distance * SHADOW_FACE_MARGIN);
    return vec4(0.5 + 0.5 * lookup, float(first_view) + face, frame.shadow_near_m / distance);
}
#endif

// Visibility of a light: 0 in shadow, 1 lit. `shadow` is the light's, `origin` its position (unused
// for directional lights).
float shadow_visibility(light_shadow shadow, vec3 origin, vec3 position, vec3 normal, vec3 to_light)
{
    if (shadow.first_view == NO_SHADOW)
        return 1.0;
    vec4 at = vec4(0.0);
    bool inside = true;
#if SINGLE_VIEW_SHADOWS
    if (shadow.view_count == 1u) {
        shadow_lookup lookup = project_to_shadow(shadow.first_view, position, normal, to_light);
#ifndef VIEWLESS // cascades belong to a view
        if (shadow.has_cascades != 0u)
            refine_by_cascade(lookup);
#endif
        at = lookup.at + vec4(lookup.lift.xy, 0.0, lookup.lift.z);
        inside = lookup.inside;
    }
#endif
#if POINT_SHADOWS
    if (shadow.view_count == 6u)
        at = project_to_cube(shadow.first_view, origin, position, normal, to_light);
#endif
    // Nothing outside the view of a spot or the sun casts shadows.
    float lit = filtered_comparison(at);
    return inside ? lit : 1.0;
}
