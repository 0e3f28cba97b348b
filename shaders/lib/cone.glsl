// Cone tracing through the voxels, for every kind of indirect light.
//
// Voxels are an absorbing and emitting volume of flakes with six orientations. A ray of direction d
// crosses optical depth sum |d_i| depth_i, read from the three faces that it enters: a wall
// occludes what is behind it at any angle, and no surface occludes what it faces. (Six faces as in
// Crassin et al. 2011, "Interactive Indirect Illumination Using Voxel Cone Tracing"; flakes as in
// Heitz et al. 2015, "The SGGX Microflake Distribution".) Steps attenuate by exp(-depth), so the
// step length does not change what a wall transmits.
//
// CONE_SMOOTH 1 blends two levels, CONE_SKIP 1 skips empty space; set by the first file that
// includes this.
#include "lib/voxel.glsl"

layout(binding = UNIT_VOXEL_RADIANCE) uniform sampler3D voxel_radiance;

struct cone {
    vec3 origin;    // relative to the anchor, m
    vec3 direction; // unit
    float tangent;  // of the half-angle
    float step;     // in diameters
    float widest;   // maximum diameter in m
    float reach_m;  // length in m
};

struct cone_light {
    vec3 light;          // radiance / the volume's scale
    float transmittance; // fraction that leaves the volume
    float occlusion;     // 0 to 1, near hits weighted more: for ambient occlusion
    float hit_m;         // distance of the step that absorbed most, and the diameter there
    float hit_diameter_m;
    float hit_density; // optical depth per metre there
};

const uint CONE_MAX_STEPS = 256u;
const float CONE_OPAQUE = 0.004;
// Filtering dilates surfaces, so bodies grow and openings shrink: each face is read so many voxels
// nearer to its body. A larger inset would turn thin walls inside out.
const float FACE_INSET = 0.25;
// Maximum step over the maximum diameter: filtering spreads a voxel over two.
const float WIDEST_STEP = 1.5;

vec3 voxel_position(vec3 world)
{
    return world - voxels.anchor;
}

// Distance of a position from the level's rim, in its voxels; negative where filtering cannot
// reach. Toroidal levels lose half a voxel, which would be filtered with the opposite side, and the
// inset of faces.
float inside_level(uint level, vec3 position)
{
    ivec3 origin = voxels.levels[level].origin;
    vec3 at = position * voxels.levels[level].inverse_voxel_edge - vec3(origin);
    vec3 rim = min(at, float(voxels.levels[level].edge) - at);
    return min(rim.x, min(rim.y, rim.z)) - (0.5 + FACE_INSET) * float(voxels.levels[level].wraps);
}

// Edge in m of the finest voxels at a position; outside all levels those of the coarsest.
float finest_voxel(vec3 position)
{
    uint level = 0u;
    bool outside;
    do {
        outside = level + 1u < voxels.cell_level_count && inside_level(level, position) < 0.0;
        level += outside ? 1u : 0u;
    } while (outside);
    return voxels.levels[level].voxel_edge_m;
}

// Start of cones in voxels above their surface: `usual`, but above a thin surface beyond the
// filtered image of its own back, which would occlude what it faces.
float cone_start(float usual, bool thin, vec3 normal)
{
    vec3 size = abs(normal);
    return thin ? max(0.5 + (1.0 + FACE_INSET) * (size.x + size.y + size.z), usual) : usual;
}

// Filtered radiance and optical depth across a voxel of the level, along a direction.
vec4 sample_level(uint level, vec3 position, vec3 direction)
{
    ivec3 origin = voxels.levels[level].origin;
    ivec3 texels = voxels.levels[level].texel_origin;
    vec3 at = position * voxels.levels[level].inverse_voxel_edge;
    float edge = float(voxels.levels[level].edge);
    at = voxels.levels[level].wraps != 0u ? at - floor(at / edge) * edge : at - vec3(origin);
    vec3 scale = 1.0 / vec3(textureSize(voxel_radiance, 0));
    vec3 uvw = (at + vec3(texels)) * scale;
#if VOXEL_DIRECTIONS == 1
    return textureLod(voxel_radiance, uvw, 0.0);
#else
    float face = float(voxels.levels[level].face_stride) * scale.x;
    vec3 size = abs(direction);
    float x = direction.x > 0.0 ? face : 0.0;
    float y = direction.y > 0.0 ? 3.0 * face : 2.0 * face;
    float z = direction.z > 0.0 ? 5.0 * face : 4.0 * face;
    vec3 inset = uvw - FACE_INSET * sign(direction) * scale;
    return size.x * textureLod(voxel_radiance, vec3(inset.x + x, uvw.yz), 0.0) +
           size.y * textureLod(voxel_radiance, vec3(uvw.x + y, inset.y, uvw.z), 0.0) +
           size.z * textureLod(voxel_radiance, vec3(uvw.x + z, uvw.y, inset.z), 0.0);
#endif
}

// Radiance and optical depth per metre, filtered over `diameter`. `out_level` is the level read
// (the finer of two), or the number of levels outside the coarsest.
vec4 sample_voxels(vec3 position, vec3 direction, float diameter, out uint out_level)
{
    float wanted = max(log2(diameter * voxels.levels[0].inverse_voxel_edge), 0.0);
    uint last = voxels.level_count - 1u;
    uint level = min(uint(wanted), last);
    float blend = min(wanted, float(last)) - float(level);
    float room;
    bool outside;
    do {
        room = inside_level(level, position);
        outside = room < 0.0;
        level += outside ? 1u : 0u;
        blend = outside ? 0.0 : blend;
    } while (outside && level <= last);
    out_level = level;
    if (level > last)
        return vec4(0.0);
    // The rim of a clip level fades into the next level.
    if (level + 1u < voxels.cell_level_count)
        blend = max(blend, 1.0 - room * 0.25);
#if CONE_SMOOTH
    vec4 fine = sample_level(level, position, direction) * voxels.levels[level].inverse_voxel_edge;
    uint coarser = min(level + 1u, last);
    vec4 coarse =
        sample_level(coarser, position, direction) * voxels.levels[coarser].inverse_voxel_edge;
    return mix(fine, coarse, level == last ? 0.0 : blend);
#else
    if (blend > 0.5 && level < last)
        level++;
    return sample_level(level, position, direction) * voxels.levels[level].inverse_voxel_edge;
#endif
}

#if CONE_SKIP
// How far to skip where a coarse level is empty: filtering reaches the neighbouring voxels, so half
// a voxel around the position is empty.
float empty_distance(uint level, vec3 position, vec3 direction)
{
    uint coarse = min(level + 2u, voxels.level_count - 1u);
    if (coarse <= level || inside_level(coarse, position) < 0.0)
        return 0.0;
    return sample_level(coarse, position, direction).a > 0.0
               ? 0.0
               : 0.5 * voxels.levels[coarse].voxel_edge_m;
}
#endif

cone_light trace_cone(cone c, float occlusion_reach_m)
{
    cone_light result;
    result.light = vec3(0.0);
    result.occlusion = 0.0;
    result.hit_m = 0.0;
    result.hit_diameter_m = voxels.levels[0].voxel_edge_m;
    result.hit_density = 0.0;
    float passed = 1.0;
    float maximum = 0.0;
    float t = 0.0;
    float voxel = voxels.levels[0].voxel_edge_m;
    uint i = t < c.reach_m ? 0u : CONE_MAX_STEPS;
    if (i < CONE_MAX_STEPS) {
        do {
            // Near its start a cone is thinner than a voxel: limit steps to one voxel there.
            float length_m = max(min(c.step, 1.0) * voxel, c.step * 2.0 * c.tangent * t);
            length_m = min(length_m, max(WIDEST_STEP * c.widest, voxel));
            float middle = t + 0.5 * length_m;
            uint level;
            // Not much narrower than the step, so that samples leave no gaps.
            float diameter = min(max(2.0 * c.tangent * middle, length_m), max(c.widest, voxel));
            vec4 value =
                sample_voxels(c.origin + middle * c.direction, c.direction, diameter, level);
            if (level >= voxels.level_count)
                break;
#if CONE_SKIP
            if (value.a == 0.0)
                length_m = max(length_m,
                               empty_distance(level, c.origin + middle * c.direction, c.direction));
#endif
            float absorbed = passed * (1.0 - exp(-value.a * length_m));
            result.light += value.rgb * (absorbed / max(value.a, 1e-12));
            result.occlusion += absorbed * max(1.0 - middle / occlusion_reach_m, 0.0);
            if (absorbed > maximum) {
                maximum = absorbed;
                result.hit_m = middle;
                result.hit_diameter_m = diameter;
                result.hit_density = value.a;
            }
            passed -= absorbed;
            t += length_m;
            // Where levels are coarser than the cone, steps follow them.
            voxel = max(voxel, diameter < voxels.levels[level].voxel_edge_m
                                   ? voxels.levels[level].voxel_edge_m
                                   : 0.0);
        } while (++i < CONE_MAX_STEPS && t < c.reach_m && passed > CONE_OPAQUE);
    }
    result.transmittance = passed > CONE_OPAQUE ? passed : 0.0;
    return result;
}
