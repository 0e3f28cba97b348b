// Adds indirect diffuse light, or writes it where it is shown ALONE. In: G-buffer, irradiance cache.
// Out: radiance in cd/m^2.
//
// An invocation takes 2x2 pixels: irradiance changes little between them, so that it is looked up
// once and again only for pixels that lie on another surface.
#define CELLS_ACCESS readonly
#include "lib/gbuffer.glsl"
#include "lib/irradiance_read.glsl"
#include "lib/indirect_reflect.glsl"
#include "lib/radiance.glsl"

layout(local_size_x = GROUP_EDGE, local_size_y = GROUP_EDGE) in;

// Two pixels share their irradiance if neither normals nor places differ by more.
const float SHARED_COSINE = 0.97;
const float SHARED_VOXELS = 0.3;

void main()
{
    uvec2 first = gl_GlobalInvocationID.xy * 2u;
    vec3 known_normal = vec3(0.0);
    vec3 known_position = vec3(0.0);
    vec4 known = vec4(0.0);
    for (uint i = 0u; i < 4u; i++) {
        uvec2 pixel = first + uvec2(i & 1u, i >> 1);
        if (any(greaterThanEqual(pixel, frame.size.xy)))
            continue;
        uint at = pixel_index(pixel);
#if ALONE
        radiance[at] = vec4(0.0, 0.0, 0.0, 1.0);
#endif
        surface s = gbuffer_load(pixel);
        if (s.shading >= SHADE_UNLIT)
            continue;
        bool shared_light = dot(s.geometric_normal, known_normal) > SHARED_COSINE &&
                            abs(dot(s.position - known_position, known_normal)) <
                                SHARED_VOXELS * voxels.levels[0].size.x;
        if (!shared_light) {
            known = cached_irradiance(s.position, s.geometric_normal);
            known_normal = s.geometric_normal;
            known_position = s.position;
        }
        radiance[at].rgb += reflect_irradiance(s, known);
    }
}
