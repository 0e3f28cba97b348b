// Environment as background and ambient light. The first pass to write radiance, so it adds
// emission, too. In: G-buffer, environment. Out: radiance in cd/m^2.
#include "lib/gbuffer.glsl"
#include "lib/environment.glsl"
#include "lib/radiance_buffer.glsl"

layout(local_size_x = PIXEL_GROUP_WIDTH, local_size_y = PIXEL_GROUP_HEIGHT) in;

void main()
{
    uvec2 pixel = gl_GlobalInvocationID.xy;
    if (any(greaterThanEqual(pixel, frame.render_size)))
        return;
    surface s = gbuffer_load(pixel);
    vec3 sum = s.emission;
    if (s.shading == SHADE_BACKGROUND)
        sum = environment_radiance(-s.view);
#if !INDIRECT_DIFFUSE // whose cones sample the environment
    else if (s.shading != SHADE_UNLIT)
        sum += environment_light(s);
#endif
    radiance[pixel_index(pixel)] = vec4(sum, 1.0);
}
