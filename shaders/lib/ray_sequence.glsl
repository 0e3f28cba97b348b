// Random numbers for rays from pixels. Those of a square of 4x4 share one low-discrepancy sequence (Keller
// and Heidrich 2001, "Interleaved Sampling"), so that averaging over a square averages all of it.

// Place of a pixel in the square's order: neighbours lie far apart in it (Bayer 1973).
uint interleaved_order(uvec2 p)
{
    uint low = ((p.x ^ p.y) & 1u) * 2u + (p.y & 1u);
    uint high = (((p.x ^ p.y) >> 1) & 1u) * 2u + ((p.y >> 1) & 1u);
    return low * 4u + high;
}

// A point of the additive recurrence on the generalised golden ratio (Roberts 2018, "The Unreasonable
// Effectiveness of Quasirandom Sequences"), and a third number for what else is left to chance.
vec3 sequence_point(uint i)
{
    uvec3 bits = uvec3(0xc13fa9a9u, 0x91e10da5u, 0x9e3779b9u) * (i + 1u);
    return vec3(bits >> 8) * (1.0 / 16777216.0);
}
