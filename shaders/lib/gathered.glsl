// What rays from pixels have found, several pictures of one size. GATHER_STEP: every how many-th pixel
// has rays.
#include "lib/surface.glsl"

layout(std430, binding = BIND_INDIRECT) buffer indirect_storage
{
    vec4 gathered_light[];
};

uvec2 gathered_size()
{
    return (frame.size.xy + uint(GATHER_STEP) - 1u) / uint(GATHER_STEP);
}

// Distance in m between neighbouring rays where they start.
float gathered_pixel_m(surface s)
{
    return length(s.position - frame.eye.xyz) * length(frame.ray_dx.xyz) * float(GATHER_STEP);
}

// Where a pixel's entry of a picture is.
uint gathered_at(uint picture, uvec2 place)
{
    uvec2 size = gathered_size();
    return (picture * size.y + place.y) * size.x + place.x;
}
