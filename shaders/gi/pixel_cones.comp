// Gathers irradiance by cones at every pixel (GATHER_STEP 1) or every second in x and y (2). The
// cones are rotated from pixel to pixel and from frame to frame. In: G-buffer, radiance texture.
// Out: sums over the frames in which nothing moved.
#define CONE_SMOOTH 1
#define PIXEL_CONES 1
#include "lib/ray_accumulation.glsl"
#include "lib/gbuffer.glsl"
#include "lib/cone_hemisphere.glsl"

layout(local_size_x = PIXEL_GROUP_WIDTH, local_size_y = PIXEL_GROUP_HEIGHT) in;

void main()
{
    uvec2 texel = gl_GlobalInvocationID.xy;
    if (any(greaterThanEqual(texel, accumulation_size())))
        return;
    surface s = gbuffer_load(texel * uint(GATHER_STEP));
    uint at = accumulation_index(PLANE_DIFFUSE, texel);
    bool first = voxels.sample_count <= 1.0;
    if (s.shading >= SHADE_UNLIT)
        return;
    // Four rotations in a square of 2x2 pixels swap pixels from frame to frame: after four frames
    // every pixel has used all of them, and the next four rotations follow.
    uint order = (texel.x & 1u) + 2u * (texel.y & 1u);
    float frame_number = voxels.sample_count - 1.0;
    float turn =
        2.0 * PI *
        fract((float(order) + frame_number) * 0.25 + floor(frame_number * 0.25) * 0.61803399);
    hemisphere g =
        begin_hemisphere(voxel_position(s.position), s.normal, s.thin, vec2(cos(turn), sin(turn)));
    cone_sum found = no_cone_sum();
    uint i = 0u;
    do {
        uint hit;
        add_cone(g, i, found, hit);
    } while (++i < uint(CONE_MARCH.cone_count));
    vec4 sum = first ? vec4(0.0) : former_sum(at);
    accumulated[at] = sum + vec4(found.light, found.ambient_visibility);
}
