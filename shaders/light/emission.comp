// Emitted radiance only, for scenes without lights. In: G-buffer. Out: radiance in cd/m^2.
#include "lib/gbuffer.glsl"
#include "lib/radiance_buffer.glsl"

layout(local_size_x = PIXEL_GROUP_WIDTH, local_size_y = PIXEL_GROUP_HEIGHT) in;

void main()
{
    uvec2 pixel = gl_GlobalInvocationID.xy;
    if (all(lessThan(pixel, frame.render_size)))
        radiance[pixel_index(pixel)] = vec4(
            unpack_emission(texelFetch(gbuffer_texels, int(2u * pixel_index(pixel) + 1u))), 1.0);
}
