// Lists the tiles of GROUP_EDGE^2 pixels with transparent fragments, for indirect dispatch. In:
// heads of the pixels' lists. Out: dispatch arguments and tile numbers, in any order.
#define FRAGMENTS_STORED
#include "lib/fragments.glsl"

layout(local_size_x = LINEAR_GROUP) in;

void main()
{
    uvec2 count = (frame.render_size + GROUP_EDGE - 1u) / GROUP_EDGE;
    uint number = gl_GlobalInvocationID.x;
    if (number >= count.x * count.y)
        return;
    uvec2 tile = uvec2(number % count.x, number / count.x);
    uvec2 last = min((tile + 1u) * GROUP_EDGE, frame.render_size);
    uint any_head = 0u;
    uint y = tile.y * GROUP_EDGE;
    do {
        uint x = tile.x * GROUP_EDGE;
        do {
            any_head |= fragment_word(head_index(uvec2(x, y)));
        } while (++x < last.x);
    } while (++y < last.y);
    if (any_head != 0u)
        fragment_words[tile_index(atomicAdd(tile_count, 1u))] = tile.y * 65536u + tile.x;
}
