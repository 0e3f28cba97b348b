// Lists of the transparent layers of each pixel, and of the tiles that hold any, in one buffer: a
// compute shader has 16 at most, and that which shades layers needs as many.
#include "lib/frame.glsl"

#ifdef FRAGMENTS_STORED
layout(std430, binding = BIND_FRAGMENTS) buffer fragment_storage
{
    uint fragment_count;    // rasterised
    uint fragment_capacity; // size of the pool
    uint fragment_unused[2];
    uint tile_count; // groups in x of the indirect dispatch; then y and z
    uint tile_groups_y;
    uint tile_groups_z;
    uint tile_unused;
    // Head of each pixel's list (0: empty, else the number of a fragment + 1); tiles with layers
    // (row * 65536 + column); fragments: the next one + 1, and the visibility id.
    uint fragment_words[];
};
#endif

layout(binding = UNIT_FRAGMENTS) uniform usamplerBuffer fragment_texels;

// A word of fragment_words, as earlier commands have left it.
uint fragment_word(uint index)
{
    return texelFetch(fragment_texels, int(index + 8u)).x;
}

uint head_index(uvec2 pixel)
{
    return pixel.y * frame.render_size.x + pixel.x;
}

uint tile_index(uint number)
{
    return frame.render_size.x * frame.render_size.y + number;
}

// Of a tile number beyond all tiles: where fragments begin.
uint fragment_index(uint number)
{
    uvec2 tiles = (frame.render_size + GROUP_EDGE - 1u) / GROUP_EDGE;
    return tile_index(tiles.x * tiles.y) + 2u * number;
}
