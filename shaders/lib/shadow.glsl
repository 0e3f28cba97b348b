// Shadow-map look-ups: percentage-closer filtering (Reeves et al. 1987) over the hardware's 2x2
// comparison, with an offset along the surface normal against acne (Holbert 2011).
#include "lib/frame.glsl"

layout(std430, binding = BIND_SHADOW_VIEWS) readonly buffer shadow_view_storage
{
    // MAX_SHADOW_LAYERS of the scene, then MAX_VIEW_SHADOW_LAYERS cascades of this view.
    shadow_view_block shadow_views[];
};

layout(binding = UNIT_SHADOW_MAP) uniform sampler2DArrayShadow shadow_map;
layout(binding = UNIT_VIEW_SHADOW_MAP) uniform sampler2DArrayShadow view_shadow_map;

const float PCF_RADIUS_TEXELS = 1.5;
const float GOLDEN_ANGLE = 2.39996323;

// Mean of comparisons on a Vogel disk around `at` (uv, layer, reference depth).
float filtered_comparison(bool of_view, vec4 at)
{
    uint taps = frame.options.z;
    float texel = of_view ? 1.0 / float(textureSize(view_shadow_map, 0).x)
                          : 1.0 / float(textureSize(shadow_map, 0).x);
    float lit = 0.0;
    for (uint i = 0u; i < taps; i++) {
        float angle = float(i) * GOLDEN_ANGLE;
        float radius = taps == 1u ? 0.0
                                  : PCF_RADIUS_TEXELS * sqrt((float(i) + 0.5) / float(taps));
        vec4 tap = at + vec4(vec2(cos(angle), sin(angle)) * (radius * texel), 0.0, 0.0);
        lit += of_view ? texture(view_shadow_map, tap) : texture(shadow_map, tap);
    }
    return lit / float(taps);
}

// Position in a shadow view: xy in [0, 1], z the reversed depth. `inside` tells whether it is seen.
vec3 project_to_shadow(uint view_number, vec3 position, vec3 normal, vec3 to_light,
                       out bool inside)
{
    shadow_view_block view = shadow_views[view_number];
    vec4 clip = view.clip_from_world * vec4(position, 1.0);
    float texel = view.texel.x * (view.texel.w > 0.0 ? max(clip.w, 0.0) : 1.0);
    float cosine = clamp(dot(normal, to_light), 0.0, 1.0);
    float offset = texel * (0.6 + 1.8 * sqrt(1.0 - cosine * cosine));
    clip = view.clip_from_world * vec4(position + normal * offset, 1.0);
    vec3 ndc = clip.xyz / max(clip.w, 1e-20);
    vec2 uv = vec2(0.5 + 0.5 * ndc.x, 0.5 - 0.5 * ndc.y);
    vec2 margin = vec2(3.0 / float(textureSize(shadow_map, 0).x));
    inside = clip.w > 0.0 && all(greaterThan(uv, margin)) && all(lessThan(uv, 1.0 - margin));
    return vec3(uv, ndc.z);
}

// Which cascade of the view a point falls into; frame.lights.w if none.
uint find_cascade(vec3 position, vec3 normal, vec3 to_light, out vec3 at)
{
    for (uint i = 0u; i < frame.lights.w; i++) {
        bool inside;
        at = project_to_shadow(MAX_SHADOW_LAYERS + i, position, normal, to_light, inside);
        if (inside)
            return i;
    }
    return frame.lights.w;
}

uint cube_face(vec3 direction)
{
    vec3 size = abs(direction);
    if (size.x >= size.y && size.x >= size.z)
        return direction.x > 0.0 ? 0u : 1u;
    if (size.y >= size.z)
        return direction.y > 0.0 ? 2u : 3u;
    return direction.z > 0.0 ? 4u : 5u;
}

// Share of a light that reaches a point: 0 in shadow, 1 lit. `shadow` is the light's, `origin` its
// position (unused for directional lights).
float shadow_visibility(uvec4 shadow, vec3 origin, vec3 position, vec3 normal, vec3 to_light)
{
    if (shadow.x == NO_SHADOW)
        return 1.0;
    vec3 at;
    if (shadow.w != 0u) {
        uint cascade = find_cascade(position, normal, to_light, at);
        if (cascade < frame.lights.w)
            return filtered_comparison(true, vec4(at.xy, float(cascade), at.z));
    }
    uint view_number = shadow.x;
    if (shadow.y == 6u)
        view_number += cube_face(position - origin);
    bool inside;
    at = project_to_shadow(view_number, position, normal, to_light, inside);
    // Cube faces overlap a little, so only spots and the sun end: beyond them nothing casts.
    if (!inside && shadow.y != 6u)
        return 1.0;
    return filtered_comparison(false, vec4(at.xy, float(view_number), at.z));
}
