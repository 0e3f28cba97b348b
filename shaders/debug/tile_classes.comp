// Debug view of what the pixels of each tile of GROUP_EDGE^2 need. Green: matte surfaces. Blue:
// surfaces with a specular trace. Cyan: transparent layers. Yellow: emission. Magenta: more than
// one of these. Dark grey: background. In: G-buffer, heads of the lists of transparent layers
// (LAYERS 1). Out: display values, shown without exposure and tone curve.
#include "lib/gbuffer.glsl"
#include "lib/radiance_buffer.glsl"

layout(local_size_x = GROUP_EDGE, local_size_y = GROUP_EDGE) in;

#if LAYERS
#include "lib/fragments.glsl"
#endif

const uint CLASS_MATTE = 1u;
const uint CLASS_GLOSSY = 2u;
const uint CLASS_TRANSPARENT = 4u;
const uint CLASS_EMISSIVE = 8u;

shared uint tile_classes;

uint pixel_classes(uvec2 pixel, surface s)
{
    uint classes = 0u;
    if (s.shading < SHADE_UNLIT) {
        bool reflects = s.metallic > 0.0 || s.f90 > 0.0;
        classes =
            reflects && s.roughness <= frame.specular_max_roughness ? CLASS_GLOSSY : CLASS_MATTE;
    }
    if (s.shading != SHADE_BACKGROUND && any(greaterThan(s.emission, vec3(0.0))))
        classes = CLASS_EMISSIVE;
#if LAYERS
    if (fragment_word(head_index(pixel)) != 0u)
        classes |= CLASS_TRANSPARENT;
#endif
    return classes;
}

vec3 class_color(uint classes)
{
    switch (classes) {
    case 0u:
        return vec3(0.12);
    case CLASS_MATTE:
        return vec3(0.35, 0.7, 0.3);
    case CLASS_GLOSSY:
        return vec3(0.3, 0.45, 0.95);
    case CLASS_TRANSPARENT:
        return vec3(0.3, 0.85, 0.9);
    case CLASS_EMISSIVE:
        return vec3(0.95, 0.85, 0.3);
    }
    return vec3(0.85, 0.3, 0.75);
}

void main()
{
    uvec2 pixel = gl_GlobalInvocationID.xy;
    if (gl_LocalInvocationIndex == 0u)
        tile_classes = 0u;
    barrier();
    bool inside = all(lessThan(pixel, frame.render_size));
    surface s = gbuffer_load(min(pixel, frame.render_size - 1u));
    if (inside)
        atomicOr(tile_classes, pixel_classes(pixel, s));
    barrier();
    if (!inside)
        return;
    // Shaded by slope to make the scene recognisable.
    float slope = s.shading == SHADE_BACKGROUND ? 1.0 : clamp(dot(s.normal, s.view), 0.0, 1.0);
    radiance[pixel_index(pixel)] = vec4(class_color(tile_classes) * (0.7 + 0.3 * slope), 1.0);
}
