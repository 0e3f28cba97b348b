// Loads surfaces from visibility ids. In: ids, depth, geometry, materials. Out: G-buffer.
#include "lib/geometry.glsl"
#include "lib/gbuffer.glsl"

layout(local_size_x = PIXEL_GROUP_WIDTH, local_size_y = PIXEL_GROUP_HEIGHT) in;

layout(binding = UNIT_IDS) uniform usampler2D ids;

void main()
{
    uvec2 pixel = gl_GlobalInvocationID.xy;
    if (any(greaterThanEqual(pixel, frame.render_size)))
        return;
    uint id = texelFetch(ids, ivec2(pixel), 0).r;
    if (id == 0u) {
        gbuffer_store_background(pixel);
        return;
    }
    transparent_layer through;
    gbuffer_store(pixel, load_surface(id, pixel_camera_ray(vec2(pixel)), through));
}
