// Random numbers for rays from pixels. The pixels of a 4x4 square share one low-discrepancy
// sequence (Keller and Heidrich 2001, "Interleaved Sampling"), so averaging over a square averages
// the whole sequence.

// Position of a pixel in the square's order: neighbours are far apart in it (Bayer 1973).
uint interleaved_order(uvec2 p)
{
    uint low = ((p.x ^ p.y) & 1u) * 2u + (p.y & 1u);
    uint high = (((p.x ^ p.y) >> 1) & 1u) * 2u + ((p.y >> 1) & 1u);
    return low * 4u + high;
}

// Shifts squares against each other, so that they miss different things (Jarzynski and Olano 2020,
// "Hash Functions for GPU Rendering": pcg3d).
uvec3 hash_square(uvec2 square)
{
    uvec3 v = uvec3(square, 1u) * 1664525u + 1013904223u;
    v.x += v.y * v.z;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v ^= v >> 16;
    v.x += v.y * v.z;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    return v;
}

// Point of the additive recurrence on the generalised golden ratio (Roberts 2018, "The Unreasonable
// Effectiveness of Quasirandom Sequences"), and a third number for other random choices.
vec3 sequence_point(uint i, uvec2 square)
{
    uvec3 bits = uvec3(0xc13fa9a9u, 0x91e10da5u, 0x9e3779b9u) * (i + 1u) + hash_square(square);
    return vec3(bits >> 8) * (1.0 / 16777216.0);
}

// Random numbers of a pixel's ray in sample `picture`.
vec3 ray_numbers(uvec2 texel, uint picture)
{
    return sequence_point(picture * 16u + interleaved_order(texel), texel >> 2);
}
