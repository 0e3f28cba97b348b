// Lists the tiles of GROUP_EDGE^2 pixels with a surface that needs a specular trace, for indirect
// dispatch. In: G-buffer. Out: dispatch arguments and tile numbers, in any order.
#include "lib/gbuffer.glsl"
#include "lib/specular_classify.glsl"

layout(local_size_x = GROUP_EDGE, local_size_y = GROUP_EDGE) in;

layout(std430, binding = BIND_GLOSSY_TILES) buffer tile_storage
{
    uint tile_count; // groups in x of the indirect dispatch; then y and z
    uint tile_groups_y;
    uint tile_groups_z;
    uint tile_unused;
    uint tiles[]; // row * 65536 + column
};

shared uint any_glossy;

void main()
{
    if (gl_LocalInvocationIndex == 0u)
        any_glossy = 0u;
    barrier();
    uvec2 pixel = gl_GlobalInvocationID.xy;
    if (all(lessThan(pixel, frame.render_size))) {
        surface s = gbuffer_load(pixel);
        if (s.shading < SHADE_UNLIT && needs_specular_trace(s))
            atomicOr(any_glossy, 1u);
    }
    barrier();
    if (gl_LocalInvocationIndex == 0u && any_glossy != 0u)
        tiles[atomicAdd(tile_count, 1u)] = gl_WorkGroupID.y * 65536u + gl_WorkGroupID.x;
}
