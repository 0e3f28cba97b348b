// Accumulation planes of ray samples, all of one size. GATHER_STEP: every how many-th pixel traces.
#include "lib/surface.glsl"
#include "shared/ray_accumulation.h"

layout(std430, binding = BIND_ACCUMULATION) writeonly buffer indirect_storage
{
    vec4 accumulated[];
};

layout(binding = UNIT_ACCUMULATION) uniform samplerBuffer accumulated_texels;

// What earlier passes and frames have written.
vec4 former_sum(uint index)
{
    return texelFetch(accumulated_texels, int(index));
}

uvec2 accumulation_size()
{
    return (frame.render_size + uint(GATHER_STEP) - 1u) / uint(GATHER_STEP);
}

// Distance in m between the origins of neighbouring rays.
float accumulation_spacing_m(surface s)
{
    return length(s.position - frame.eye) * length(frame.ray_dx) * float(GATHER_STEP);
}

// Index of a pixel in a plane.
uint accumulation_index(uint picture, uvec2 texel)
{
    uvec2 size = accumulation_size();
    return (picture * size.y + texel.y) * size.x + texel.x;
}

#if RAY_SHADOWS
// Behind the planes, at full resolution: per pixel the sum of light visibility, and the sample
// count.
uint visibility_index(uvec2 pixel)
{
    return accumulation_index(uint(VISIBILITY_PLANE), uvec2(0)) + pixel.y * frame.render_size.x +
           pixel.x;
}
#endif

// Neighbours that are off a surface's plane by a pixel's width at its distance hardly count.
const float PLANE_PIXELS = 1.0;

// Similarity of a neighbour's surface; `pixel_m`: distance in m between the compared pixels.
float likeness(surface s, surface n, float pixel_m)
{
    float off = dot(n.position - s.position, s.geometric_normal) / (PLANE_PIXELS * pixel_m);
    float cosine = max(dot(n.normal, s.normal), 0.0);
    float cosine8 = cosine * cosine;
    cosine8 *= cosine8;
    cosine8 *= cosine8;
    return n.shading < SHADE_UNLIT ? exp(-off * off) * cosine8 : 0.0;
}

// Weights of a 5x5 window whose rim counts half: it contains each position of the interleaved 4x4
// square once, so per-pixel noise cancels on a plane.
float window_weight(int x, int y)
{
    return (abs(x) == 2 ? 0.5 : 1.0) * (abs(y) == 2 ? 0.5 : 1.0);
}
