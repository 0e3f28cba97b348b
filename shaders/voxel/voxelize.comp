// Voxelizes triangles. In: geometry, material textures, regions and batches of triangles. Out:
// surfels, and in the index the first surfel of each touched voxel.
//
// LARGE 0: an invocation takes a triangle, walks the voxel columns along its dominant axis, and
// splits triangles of many columns into tiles. LARGE 1: a group takes a tile, an invocation a
// column.
#include "lib/geometry.glsl"
#include "lib/voxel_surfels.glsl"
#include "lib/voxel_overlap.glsl"

#if LARGE
layout(local_size_x = VOXEL_TILE_EDGE, local_size_y = VOXEL_TILE_EDGE) in;
#else
layout(local_size_x = VOXEL_BATCH) in;
#endif

layout(binding = UNIT_VOXEL_SURFACES) uniform usamplerBuffer surfaces; // of each instance

layout(std430, binding = BIND_VOXEL_TILES) buffer tile_storage
{
    voxel_tile tiles[];
};

// A triangle prepared for the walk. Axes a and b span the columns; c is the dominant axis.
struct walk {
    overlap_triangle t;
    instance_words instance;
    uvec3 texels; // first texel of each vertex
    uint axis;    // 0: abc = yzx, 1: zxy, 2: xyz
    uint key;
    vec3 normal; // unit, world
    float area;  // in squared voxel edges
    uint level;
    ivec3 low; // intersection of the region and the triangle's box, abc
    ivec3 high;
    uint spare;
};

dvec3 to_abc(dvec3 v, uint axis)
{
    return axis == 0u ? v.yzx : axis == 1u ? v.zxy : v;
}

ivec3 to_abc(ivec3 v, uint axis)
{
    return axis == 0u ? v.yzx : axis == 1u ? v.zxy : v;
}

ivec3 from_abc(ivec3 v, uint axis)
{
    return axis == 0u ? v.zxy : axis == 1u ? v.yzx : v;
}

vec3 from_abc(vec3 v, uint axis)
{
    return axis == 0u ? v.zxy : axis == 1u ? v.yzx : v;
}

uint mask_from_abc(uint mask, uint axis)
{
    if (axis == 2u)
        return mask;
    uint turned = 0u;
    for (uint i = 0u; i < 8u; i++) {
        uint a = i & 1u, b = (i >> 1) & 1u, c = i >> 2;
        uint bit = axis == 0u ? c + 2u * a + 4u * b : b + 2u * c + 4u * a;
        turned |= ((mask >> i) & 1u) << bit;
    }
    return turned;
}

// False if the triangle has no area, is not finite, or lies outside the region.
bool begin_walk(uint instance, uint triangle_number, uint region, out walk w)
{
    w.instance = load_instance(instance);
    w.texels =
        texelFetch(triangles, int(w.instance.first_triangle + triangle_number)).xyz * VERTEX_TEXELS;
    voxel_region where = load_region(region);
    w.level = where.level;
    w.spare = VOXEL_NONE;
    mat4 m = load_transform(instance);
    dvec3 columns[4] = {dvec3(m[0].xyz), dvec3(m[1].xyz), dvec3(m[2].xyz), dvec3(m[3].xyz)};
    double edge = double(voxels.levels[w.level].voxel_edge_m);
    dvec3 v[3];
    for (int i = 0; i < 3; i++) {
        dvec3 local = dvec3(vertex_floats(w.texels[i]).xyz);
        precise dvec3 world =
            columns[0] * local.x + columns[1] * local.y + columns[2] * local.z + columns[3];
        v[i] = (world - dvec3(voxels.anchor)) / edge;
    }
    precise dvec3 normal = cross(v[1] - v[0], v[2] - v[0]);
    vec3 n = vec3(normal);
    float size = length(n);
    if (!(size > 0.0) || isinf(size))
        return false;
    w.area = 0.5 * size;
    w.normal = n / size;
    if ((w.instance.flags & INSTANCE_MIRRORED) != 0u)
        w.normal = -w.normal;
    w.key = texelFetch(surfaces, int(instance)).x * 8u + dominant_face(w.normal);
    w.axis = dominant_face(w.normal) >> 1u;
    for (int i = 0; i < 3; i++)
        w.t.v[i] = to_abc(v[i], w.axis);
    w.t.normal = to_abc(normal, w.axis);
    w.t.low = min(min(w.t.v[0], w.t.v[1]), w.t.v[2]);
    w.t.high = max(max(w.t.v[0], w.t.v[1]), w.t.v[2]);
    ivec3 region_low = to_abc(where.low, w.axis);
    ivec3 region_high = region_low + to_abc(where.size, w.axis) - 1;
    // Clamped before the conversion, so that it cannot overflow.
    dvec3 minimum = clamp(ceil(w.t.low) - 1.0lf, dvec3(region_low), dvec3(region_high) + 1.0lf);
    dvec3 maximum = clamp(floor(w.t.high), dvec3(region_low) - 1.0lf, dvec3(region_high));
    w.low = ivec3(minimum);
    w.high = ivec3(maximum);
    return all(lessThanEqual(w.low, w.high));
}

#if VOXEL_COLORS && COLOR_CLASSES > 0
// Widens the voxel's footprint to a square of its longer side: one sample suffices, whatever the
// quality of the frame that voxelizes.
void square_footprint(inout texture_point point, UV_VECTOR dx, UV_VECTOR dy)
{
    float first = sqrt(max(dot(dx.xy, dx.xy), dot(dy.xy, dy.xy)));
#if SECOND_UV_SET
    float second = sqrt(max(dot(dx.zw, dx.zw), dot(dy.zw, dy.zw)));
    point.dx = vec4(first, 0.0, second, 0.0);
    point.dy = vec4(0.0, first, 0.0, second);
#else
    point.dx = vec2(first, 0.0);
    point.dy = vec2(0.0, first);
#endif
}
#endif

#if VOXEL_COLORS
// Samples textures at the level that fits the voxel, at a point of the triangle.
void sample_surface(walk w, vec3 weights, inout voxel_fragment f)
{
    material_block material = load_material(w.instance.material);
    vec4 base = vec4(1.0);
#if VERTEX_COLORS
    base = interpolate_color(w.texels, weights);
#endif
#if COLOR_CLASSES > 0
    if ((material.texture_mask & COLOR_TEXTURE_SLOTS) != 0u) {
        texture_point point;
        point.level_dither = 0.0;
        UV_VECTOR uv[3] = {vertex_uv(w.texels.x), vertex_uv(w.texels.y), vertex_uv(w.texels.z)};
        vec2 e1 = vec2(w.t.v[1].xy - w.t.v[0].xy);
        vec2 e2 = vec2(w.t.v[2].xy - w.t.v[0].xy);
        float inverse = 1.0 / float(w.t.normal.z);
        point.uv = uv[0] * weights.x + uv[1] * weights.y + uv[2] * weights.z;
        square_footprint(point, ((uv[1] - uv[0]) * e2.y - (uv[2] - uv[0]) * e1.y) * inverse,
                         ((uv[2] - uv[0]) * e1.x - (uv[1] - uv[0]) * e2.x) * inverse);
        uint slots = material.texture_mask & COLOR_TEXTURE_SLOTS;
        do {
            uint slot = uint(findLSB(slots));
            vec4 texel = sample_color(material.first_texture + slot, point);
            base *= slot == TEXTURE_BASE_COLOR ? texel : vec4(1.0);
            f.emission *= slot == TEXTURE_EMISSIVE ? texel.rgb : vec3(1.0);
        } while ((slots &= slots - 1u) != 0u);
    }
#endif
    f.color = clamp(base.rgb, 0.0, 1.0);
    f.opacity = clamp(base.a, 0.0, 1.0);
}
#endif

void add_voxel(inout walk w, ivec3 voxel, uint mask)
{
    // Centre of the touched columns, on the triangle's plane.
    uint columns = (mask | (mask >> 4)) & 15u;
    float count = float(bitCount(columns));
    vec2 middle = vec2(0.25 + 0.5 * float(bitCount(columns & 10u)) / count,
                       0.25 + 0.5 * float(bitCount(columns & 12u)) / count);
    dvec2 at = dvec2(voxel.xy) + dvec2(middle);
    dvec3 n = w.t.normal;
    double depth = w.t.v[0].z - (n.x * (at.x - w.t.v[0].x) + n.y * (at.y - w.t.v[0].y)) / n.z;
    depth = clamp(clamp(depth, w.t.low.z, w.t.high.z), double(voxel.z), double(voxel.z) + 1.0lf);
    voxel_fragment f;
    f.mask = mask_from_abc(mask, w.axis);
    f.normal = w.normal;
    f.sub_voxel_position = from_abc(vec3(middle, float(depth - double(voxel.z))), w.axis);
    f.opacity = 1.0;
    f.color = vec3(1.0);
    f.emission = vec3(1.0);
    // Area in the voxel: that of the touched columns, but at most the triangle's.
    float slope = abs(float(n.z)) / length(vec3(n));
    f.weight = max(1u, uint(min(w.area, 0.25 * count / slope) * float(SURFEL_WEIGHT_SCALE) + 0.5));
#if VOXEL_COLORS
    dvec2 e1 = w.t.v[1].xy - w.t.v[0].xy;
    dvec2 e2 = w.t.v[2].xy - w.t.v[0].xy;
    dvec2 d = at - w.t.v[0].xy;
    vec2 bc = vec2(dvec2(d.x * e2.y - d.y * e2.x, e1.x * d.y - e1.y * d.x) / n.z);
    vec3 weights = max(vec3(1.0 - bc.x - bc.y, bc), 0.0);
    sample_surface(w, weights / (weights.x + weights.y + weights.z), f);
#endif
    ivec3 address = from_abc(voxel, w.axis);
    uint word = voxels.levels[w.level].first_index + voxel_slot(w.level, address);
    uint surfel = find_surfel(word, w.key, w.spare);
    if (surfel != VOXEL_NONE)
        add_fragment(surfel, f);
}

// Adds the voxels of one column that the triangle touches.
void walk_column(inout walk w, ivec2 column)
{
    dvec3 n = w.t.normal;
    dvec2 from = dvec2(column) - w.t.v[0].xy;
    double near = w.t.v[0].z - (n.x * from.x + n.y * from.y) / n.z;
    dvec2 slope = -n.xy / n.z;
    double minimum = near + min(slope.x, 0.0lf) + min(slope.y, 0.0lf);
    double maximum = near + max(slope.x, 0.0lf) + max(slope.y, 0.0lf);
    // Slightly wider against rounding; the exact test decides.
    int first =
        int(clamp(ceil(minimum - 1e-6lf) - 1.0lf, double(w.low.z), double(w.high.z) + 1.0lf));
    int last = int(clamp(floor(maximum + 1e-6lf), double(w.low.z) - 1.0lf, double(w.high.z)));
    int c = first;
    if (c > last)
        return;
    do {
        ivec3 voxel = ivec3(column, c);
        uint mask = touched_voxel_halves(w.t, dvec3(voxel));
        if (mask != 0u)
            add_voxel(w, voxel, mask);
    } while (++c <= last);
}

#if LARGE
void main()
{
    voxel_tile tile = tiles[gl_WorkGroupID.x];
    walk w;
    if (!begin_walk(tile.instance, tile.triangle, tile.region, w))
        return;
    ivec2 column = w.low.xy + ivec2(tile.columns & 0xffffu, tile.columns >> 16) * VOXEL_TILE_EDGE +
                   ivec2(gl_LocalInvocationID.xy);
    if (all(lessThanEqual(column, w.high.xy)))
        walk_column(w, column);
    give_back_surfel(w.spare);
}
#else
// Splits a triangle of many columns into tiles; false if there is no room for them.
bool leave_tiles(walk w, uint instance, uint triangle_number, uint region)
{
    uvec2 count = uvec2(w.high.xy - w.low.xy) / VOXEL_TILE_EDGE + 1u;
    uint total = count.x * count.y;
    uint first = atomicAdd(counters[COUNTER_TILES], total);
    if (first + total > voxels.tile_capacity) {
        // Slots below the capacity must be harmless to process: repeating the same tile is.
        for (uint i = first; i < min(first + total, voxels.tile_capacity); i++)
            tiles[i] = voxel_tile(instance, triangle_number, region, 0xffffffffu);
        return false;
    }
    uint i = 0u;
    do {
        tiles[first + i] =
            voxel_tile(instance, triangle_number, region, (i % count.x) | ((i / count.x) << 16));
    } while (++i < total);
    return true;
}

void main()
{
    voxel_batch batch = load_batch(gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x);
    if (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x >= voxels.batch_count ||
        gl_LocalInvocationID.x >= batch.triangle_count)
        return;
    uint triangle_number = batch.first_triangle + gl_LocalInvocationID.x;
    walk w;
    if (!begin_walk(batch.instance, triangle_number, batch.region, w))
        return;
    ivec2 size = w.high.xy - w.low.xy + 1;
    int count = size.x * size.y;
    if (count > VOXEL_SMALL_COLUMNS &&
        leave_tiles(w, batch.instance, triangle_number, batch.region))
        return;
    int i = 0;
    do {
        walk_column(w, w.low.xy + ivec2(i % size.x, i / size.x));
    } while (++i < count);
    give_back_surfel(w.spare);
}
#endif
