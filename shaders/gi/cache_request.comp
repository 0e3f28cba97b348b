// Pixels request the voxel faces that they show: one pixel of each REQUEST_EDGE^2, a different one
// each frame. In: G-buffer, cells. Out: newest request of the faces.
#include "lib/gbuffer.glsl"
#include "lib/cache_request.glsl"

layout(local_size_x = PIXEL_GROUP_WIDTH, local_size_y = PIXEL_GROUP_HEIGHT) in;

const uint REQUEST_EDGE = 4u;

void main()
{
    uint turn = (voxels.frame_number * 5u) & 15u;
    uvec2 pixel = gl_GlobalInvocationID.xy * REQUEST_EDGE + uvec2(turn & 3u, turn >> 2);
    if (any(greaterThanEqual(pixel, frame.render_size)))
        return;
    surface s = gbuffer_load(pixel);
    if (s.shading < SHADE_UNLIT)
        request_faces(s.position, s.geometric_normal, voxels.frame_number);
}
