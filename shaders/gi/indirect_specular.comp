// Adds what glossy surfaces mirror, one cone a pixel, in the tiles that hold any (one group each). In:
// tiles, G-buffer, radiance texture. Out: radiance in cd/m^2.
#define CONE_SMOOTH 1
#define CONE_SKIP 1
#include "lib/gbuffer.glsl"
#include "lib/environment.glsl"
#include "lib/gloss.glsl"
#include "lib/radiance.glsl"

layout(local_size_x = GROUP_EDGE, local_size_y = GROUP_EDGE) in;

layout(std430, binding = BIND_TILES) readonly buffer tile_storage
{
    uvec4 tile_arguments;
    uint tiles[];
};

void main()
{
    uint tile = tiles[gl_WorkGroupID.x];
    uvec2 pixel = uvec2(tile & 0xffffu, tile >> 16) * GROUP_EDGE + gl_LocalInvocationID.xy;
    if (any(greaterThanEqual(pixel, frame.size.xy)))
        return;
    surface s = gbuffer_load(pixel);
    if (s.shading >= SHADE_UNLIT || s.roughness >= voxels.light.z)
        return;
    vec3 mirror = reflect(-s.view, s.normal);
    // A normal map can turn the mirror ray into the surface.
    mirror += s.geometric_normal * max(0.01 - dot(mirror, s.geometric_normal), 0.0);
    vec3 light = trace_gloss(s.position, s.geometric_normal, normalize(mirror), s.roughness);
    float n_v = clamp(dot(s.normal, s.view), 0.0, 1.0);
    vec2 scale_bias = environment_brdf(s.roughness, n_v);
    vec3 f0 = mix(s.f0, s.base_color, s.metallic);
    float f90 = mix(s.f90, 1.0, s.metallic);
    vec3 reflected = f0 * scale_bias.x + f90 * scale_bias.y;
    radiance[pixel_index(pixel)].rgb += reflected * light * (s.occlusion * voxels.light.y);
}
