// Averages what pixels have gathered over the neighbours that lie on the same surface. In: G-buffer,
// sums. Out: means.
//
// A window of 5x5 whose rim counts half holds each place of an interleaved square of 4x4 once, so that
// on a plane the noise of single pixels cancels.
#include "lib/gbuffer.glsl"
#include "lib/voxel.glsl"

layout(local_size_x = GROUP_EDGE, local_size_y = GROUP_EDGE) in;

layout(std430, binding = BIND_INDIRECT) buffer indirect_storage
{
    vec4 gathered[]; // sums; then the same filtered
};

// Neighbours off a surface's plane by a pixel's width at its distance hardly count.
const float PLANE_PIXELS = 1.0;

void main()
{
    ivec2 place = ivec2(gl_GlobalInvocationID.xy);
    ivec2 size = ivec2((frame.size.xy + uint(GATHER_STEP) - 1u) / uint(GATHER_STEP));
    if (any(greaterThanEqual(place, size)))
        return;
    surface s = gbuffer_load(uvec2(place * GATHER_STEP));
    int at = place.y * size.x + place.x;
    if (s.shading >= SHADE_UNLIT)
        return;
    float pixel_m = length(s.position - frame.eye.xyz) * length(frame.ray_dx.xyz) * float(GATHER_STEP);
    vec4 sum = gathered[at];
    float weight = 1.0;
    for (int y = -2; y <= 2; y++)
        for (int x = -2; x <= 2; x++) {
            ivec2 other = place + ivec2(x, y);
            if ((x == 0 && y == 0) || any(lessThan(other, ivec2(0))) ||
                any(greaterThanEqual(other, size)))
                continue;
            surface n = gbuffer_load(uvec2(other * GATHER_STEP));
            float off = dot(n.position - s.position, s.geometric_normal) / (PLANE_PIXELS * pixel_m);
            float cosine = max(dot(n.normal, s.normal), 0.0);
            float cosine8 = cosine * cosine;
            cosine8 *= cosine8;
            cosine8 *= cosine8;
            float w = exp(-off * off) * cosine8 * (abs(x) == 2 ? 0.5 : 1.0) *
                      (abs(y) == 2 ? 0.5 : 1.0);
            if (n.shading >= SHADE_UNLIT)
                w = 0.0;
            sum += w * gathered[other.y * size.x + other.x];
            weight += w;
        }
    gathered[size.x * size.y + at] = sum / (weight * voxels.settle.y);
}
