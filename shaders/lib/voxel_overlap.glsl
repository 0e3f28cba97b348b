// Which halves of a voxel a triangle overlaps: separating-axis test of a triangle and a closed box
// (Akenine-Moeller 2001, "Fast 3D Triangle-Box Overlap Testing"; as projections, Schwarz and Seidel
// 2010, "Fast Parallel Surface and Solid Voxelization on GPUs"), in double.
//
// Coordinates are in voxels, rotated so that Z is the triangle's dominant axis. A voxel is
// overlapped if any of its eight halves (2^3) is, since their union is the closed voxel.

struct overlap_triangle {
    dvec3 v[3];
    dvec3 normal; // not normalised; cross product of two edges
    dvec3 low;
    dvec3 high;
};

// Halves of a square that the projected triangle overlaps: bit x + 2 y. `low` is the square's
// corner.
uint touched_squares(dvec2 a, dvec2 b, dvec2 c, bool clockwise, dvec2 low)
{
    dvec2 from[3] = {a, b, c};
    dvec2 to[3] = {b, c, a};
    uint mask = 15u;
    for (int i = 0; i < 3; i++) {
        precise dvec2 edge = to[i] - from[i];
        precise dvec2 n = clockwise ? dvec2(edge.y, -edge.x) : dvec2(-edge.y, edge.x);
        precise double at = n.x * (low.x - from[i].x) + n.y * (low.y - from[i].y) +
                            (max(n.x, 0.0lf) + max(n.y, 0.0lf)) * 0.5lf;
        precise dvec2 h = n * 0.5lf;
        mask &= (at >= 0.0lf ? 1u : 0u) | (at + h.x >= 0.0lf ? 2u : 0u) |
                (at + h.y >= 0.0lf ? 4u : 0u) | (at + h.x + h.y >= 0.0lf ? 8u : 0u);
    }
    return mask;
}

// Halves of [low, low + 1] that overlap [from, to]: bit 0 the lower, bit 1 the upper.
uint touched_halves(double low, double from, double to)
{
    return (from <= low + 0.5lf && to >= low ? 1u : 0u) |
           (from <= low + 1.0lf && to >= low + 0.5lf ? 2u : 0u);
}

// Bit x + 2 y + 4 z per half of the voxel at `low`.
uint touched_voxel_halves(overlap_triangle t, dvec3 low)
{
    uint xy = touched_squares(t.v[0].xy, t.v[1].xy, t.v[2].xy, t.normal.z < 0.0lf, low.xy);
    uint yz = touched_squares(t.v[0].yz, t.v[1].yz, t.v[2].yz, t.normal.x < 0.0lf, low.yz);
    uint zx = touched_squares(t.v[0].zx, t.v[1].zx, t.v[2].zx, t.normal.y < 0.0lf, low.zx);
    uint x = touched_halves(low.x, t.low.x, t.high.x);
    uint y = touched_halves(low.y, t.low.y, t.high.y);
    uint z = touched_halves(low.z, t.low.z, t.high.z);
    precise dvec3 n = t.normal;
    precise dvec3 from = low - t.v[0];
    precise double plane = n.x * from.x + n.y * from.y + n.z * from.z;
    precise double minimum = (min(n.x, 0.0lf) + min(n.y, 0.0lf) + min(n.z, 0.0lf)) * 0.5lf;
    precise double maximum = (max(n.x, 0.0lf) + max(n.y, 0.0lf) + max(n.z, 0.0lf)) * 0.5lf;
    uint mask = 0u;
    for (uint i = 0u; i < 8u; i++) {
        uint ix = i & 1u, iy = (i >> 1) & 1u, iz = i >> 2;
        precise double at = plane + n.x * (0.5lf * double(ix)) + n.y * (0.5lf * double(iy)) +
                            n.z * (0.5lf * double(iz));
        bool inside = at + minimum <= 0.0lf && at + maximum >= 0.0lf;
        uint projections = (xy >> (ix + 2u * iy)) & (yz >> (iy + 2u * iz)) & (zx >> (iz + 2u * ix));
        uint extents = (x >> ix) & (y >> iy) & (z >> iz);
        mask |= inside ? (projections & extents & 1u) << i : 0u;
    }
    return mask;
}
