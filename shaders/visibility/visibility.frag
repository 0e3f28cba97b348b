// Writes the triangle's visibility id (colour), after the alpha test of masked materials. LIST:
// instead appends the fragment to its pixel's list of transparent layers.
#if SHADOW_VIEW
// Views of different quality share shadow maps, which must not depend on it.
#define TEXTURE_ANISOTROPY 1.0
#endif
#include "lib/material.glsl"

layout(location = 0) flat in uvec2 fragment_numbers; // visibility id, material

#if ALPHA_MASK
layout(location = 1) in vec4 fragment_uv;
layout(location = 2) in float fragment_alpha;

void test_alpha()
{
    material_block material = load_material(fragment_numbers.y);
    float alpha = material.base_color.a * fragment_alpha;
#if COLOR_CLASSES > 0
    texture_point point = texture_point(UV_VECTOR(fragment_uv), UV_VECTOR(dFdx(fragment_uv)),
                                        UV_VECTOR(dFdy(fragment_uv)), 0.0);
    if ((material.texture_mask & (1u << TEXTURE_BASE_COLOR)) != 0u)
        alpha *= sample_color(material.first_texture + TEXTURE_BASE_COLOR, point).a;
#endif
    if (alpha < material.alpha_cutoff)
        discard;
}
#endif

#if LIST
#define FRAGMENTS_STORED
#include "lib/fragments.glsl"

layout(early_fragment_tests) in;

void append(uint id)
{
    uint slot = atomicAdd(fragment_count, 1u);
    if (slot >= fragment_capacity)
        return;
    uint base = fragment_index(slot);
    uint head = head_index(uvec2(gl_FragCoord.xy));
    fragment_words[base] = atomicExchange(fragment_words[head], slot + 1u);
    fragment_words[base + 1u] = id;
}
#elif !SHADOW_VIEW
layout(location = 0) out uint visibility_id;
#endif

void main()
{
#if ALPHA_MASK
    test_alpha();
#endif
    uint id = fragment_numbers.x;
#if LIST
    append(id);
#elif !SHADOW_VIEW
    visibility_id = id;
#endif
}
