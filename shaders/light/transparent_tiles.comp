// Lists the tiles of GROUP_EDGE^2 pixels with transparent fragments, for indirect dispatch. In:
// heads of the pixels' lists. Out: dispatch arguments and tile numbers, in any order.
#include "lib/frame.glsl"

layout(local_size_x = LINEAR_GROUP) in;

layout(std430, binding = BIND_FRAGMENTS) readonly buffer fragment_storage
{
    uint fragment_count;    // rasterised
    uint fragment_capacity; // size of the pool
    uint fragment_unused[2];
    uint fragment_words[];
};

layout(std430, binding = BIND_TILES) buffer tile_storage
{
    uint tile_count; // groups in x of the indirect dispatch; then y and z
    uint tile_groups_y;
    uint tile_groups_z;
    uint tile_unused;
    uint tiles[]; // row * 65536 + column
};

void main()
{
    uvec2 count = (frame.render_size + GROUP_EDGE - 1u) / GROUP_EDGE;
    uint number = gl_GlobalInvocationID.x;
    if (number >= count.x * count.y)
        return;
    uvec2 tile = uvec2(number % count.x, number / count.x);
    uvec2 last = min((tile + 1u) * GROUP_EDGE, frame.render_size);
    uint any_head = 0u;
    for (uint y = tile.y * GROUP_EDGE; y < last.y; y++)
        for (uint x = tile.x * GROUP_EDGE; x < last.x; x++)
            any_head |= fragment_words[y * frame.render_size.x + x];
    if (any_head != 0u)
        tiles[atomicAdd(tile_count, 1u)] = tile.y * 65536u + tile.x;
}
