// What rays from pixels have found, several pictures of one size. GATHER_STEP: every how many-th
// pixel has rays.
#include "lib/surface.glsl"
#include "shared/ray_accumulation.h"

layout(std430, binding = BIND_INDIRECT) buffer indirect_storage
{
    vec4 accumulated[];
};

uvec2 accumulation_size()
{
    return (frame.render_size + uint(GATHER_STEP) - 1u) / uint(GATHER_STEP);
}

// Distance in m between neighbouring rays where they start.
float accumulation_spacing_m(surface s)
{
    return length(s.position - frame.eye) * length(frame.ray_dx) * float(GATHER_STEP);
}

// Where a pixel's entry of a picture is.
uint accumulation_index(uint picture, uvec2 texel)
{
    uvec2 size = accumulation_size();
    return (picture * size.y + texel.y) * size.x + texel.x;
}

#if RAY_SHADOWS
// Behind the pictures: of each pixel, sums of the shares of lights' light that arrive, and their
// number.
uint visibility_index(uvec2 pixel)
{
    return accumulation_index(uint(VISIBILITY_PLANE), uvec2(0)) + pixel.y * frame.render_size.x +
           pixel.x;
}
#endif

// Neighbours off a surface's plane by a pixel's width at its distance hardly count.
const float PLANE_PIXELS = 1.0;

// How much a neighbour is of the same surface; `pixel_m`: distance in m between the pixels
// compared.
float likeness(surface s, surface n, float pixel_m)
{
    float off = dot(n.position - s.position, s.geometric_normal) / (PLANE_PIXELS * pixel_m);
    float cosine = max(dot(n.normal, s.normal), 0.0);
    float cosine8 = cosine * cosine;
    cosine8 *= cosine8;
    cosine8 *= cosine8;
    return n.shading < SHADE_UNLIT ? exp(-off * off) * cosine8 : 0.0;
}

// Of a window of 5x5 whose rim counts half, which holds each place of an interleaved square of 4x4
// once, so that on a plane the noise of single pixels cancels.
float window_weight(int x, int y)
{
    return (abs(x) == 2 ? 0.5 : 1.0) * (abs(y) == 2 ? 0.5 : 1.0);
}
