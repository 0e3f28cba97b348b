// Direct light from punctual and area lights. In: G-buffer, lights, shadow maps; RAY_SHADOWS:
// traced visibility of area and sphere lights. Out: radiance in cd/m^2, added to the environment
// pass's (FIRST 0), to emission (1), or alone (2: the debug view of direct light).
#include "lib/gbuffer.glsl"
#include "lib/lighting.glsl"
#include "lib/radiance_buffer.glsl"
#include "lib/ray_shadow_filter.glsl"
#include "shared/display.h"

layout(local_size_x = PIXEL_GROUP_WIDTH, local_size_y = PIXEL_GROUP_HEIGHT) in;

void main()
{
    uvec2 pixel = gl_GlobalInvocationID.xy;
    if (any(greaterThanEqual(pixel, frame.render_size)))
        return;
    surface s = gbuffer_load(pixel);
#if ADDED_TO == ADDED_TO_EMISSION
    vec3 sum = s.emission;
#elif ADDED_TO == ADDED_TO_NOTHING
    vec3 sum = vec3(0.0);
#else
    vec3 sum = former_radiance(pixel_index(pixel));
#endif
    if (s.shading < SHADE_UNLIT) {
#if RAY_SHADOWS
        traced_visibility = filtered_visibility(s, pixel);
#endif
        sum += direct_light(s, pixel);
    }
    radiance[pixel_index(pixel)] = vec4(sum, 1.0);
}
