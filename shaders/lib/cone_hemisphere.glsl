// Irradiance from a hemisphere of cones.
#include "lib/cone.glsl"
#include "lib/environment.glsl"

// The set of cones: the pixels' or the cache's.
#if PIXEL_CONES
#define CONE_MARCH voxels.pixel_march
#define CONES      voxels.pixel_cones
#else
#define CONE_MARCH voxels.cache_march
#define CONES      voxels.cache_cones
#endif

// Roughness whose lobe is about as wide as a cone, for the environment's prefiltered levels.
const float CONE_ROUGHNESS = 0.5;

struct cone_sum {
    vec3 light; // irradiance / pi / the volume's scale
    float ambient_visibility;
};

// The cone set around a normal.
struct hemisphere {
    mat3 axes;
    cone c; // without the direction
};

cone_sum no_cone_sum()
{
    cone_sum none;
    none.light = vec3(0.0);
    none.ambient_visibility = 0.0;
    return none;
}

// `position` is relative to the anchor; `turn` is cosine and sine of the rotation about the normal.
hemisphere begin_hemisphere(vec3 position, vec3 normal, bool thin, vec2 turn)
{
    hemisphere g;
    mat3 axes = frame_about(normal);
    g.axes = mat3(axes[0] * turn.x + axes[1] * turn.y, axes[1] * turn.x - axes[0] * turn.y, normal);
    float voxel = finest_voxel(position);
    g.c.origin = position + normal * (cone_start(CONE_MARCH.start_voxels, thin, normal) * voxel);
    g.c.tangent = CONE_MARCH.tan_half_angle;
    g.c.step = CONE_MARCH.step_diameters;
    g.c.widest = voxels.cone_max_diameter_m;
    g.c.reach_m = 1e30;
    return g;
}

#if ENVIRONMENT_LIGHT
vec3 escaped_light(vec3 direction, float transmittance)
{
    return environment_specular(direction, CONE_ROUGHNESS) *
           (transmittance / voxels.radiance_scale);
}
#endif

// Filtering reaches through a wall one voxel thick: at the densest step its far side is mixed in,
// and a ray against a slanted wall sees it. So radiance is read at the front of the wall: as far
// before the hit as density remains.
const float FRONT_DIAMETERS[2] = float[](0.75, 0.4);
const float FRONT_DENSITY = 0.05;

float front_of_hit(cone c, cone_light found)
{
    for (int i = 0; i < 2; i++) {
        float at_m = max(found.hit_m - FRONT_DIAMETERS[i] * found.hit_diameter_m, 0.0);
        uint level;
        vec4 value =
            sample_voxels(c.origin + at_m * c.direction, c.direction, found.hit_diameter_m, level);
        if (value.a > FRONT_DENSITY * found.hit_density)
            return at_m;
    }
    return found.hit_m;
}

// Traces cone `i` and adds its contribution. `out_hit` packs its main hit: distance in voxels of
// the finest level (half), transmittance (8 bits), log2 of the diameter in those voxels (8 bits, in
// sixteenths).
void add_cone(hemisphere g, uint i, inout cone_sum sum, out uint out_hit)
{
    voxel_cone local = CONES[i];
    g.c.direction = g.axes * local.direction;
    cone_light found = trace_cone(g.c, voxels.ao_radius_m);
    vec3 light = found.light;
#if ENVIRONMENT_LIGHT
    light += escaped_light(g.c.direction, found.transmittance);
#endif
    sum.light += local.weight * light;
    sum.ambient_visibility += local.weight * (1.0 - found.occlusion);
    found.hit_m = front_of_hit(g.c, found);
    float inverse = voxels.levels[0].inverse_voxel_edge;
    float diameter = clamp(log2(found.hit_diameter_m * inverse) * 16.0, 0.0, 255.0);
    uint fraction = uint(found.transmittance * 255.0 + 0.5);
    out_hit = (packHalf2x16(vec2(found.hit_m * inverse, 0.0)) & 0xffffu) | (fraction << 16) |
              (uint(diameter + 0.5) << 24);
}

// Adds the present radiance at the stored hit of cone `i`.
void add_cone_at_hit(hemisphere g, uint i, uint word, inout cone_sum sum)
{
    voxel_cone local = CONES[i];
    vec3 direction = g.axes * local.direction;
    float hit_m = unpackHalf2x16(word & 0xffffu).x * voxels.levels[0].voxel_edge_m;
    float transmittance = float((word >> 16) & 0xffu) / 255.0;
    float diameter = exp2(float(word >> 24) / 16.0) * voxels.levels[0].voxel_edge_m;
    uint level;
    vec4 value = sample_voxels(g.c.origin + hit_m * direction, direction, diameter, level);
    vec3 light = value.rgb * ((1.0 - transmittance) / max(value.a, 1e-12));
#if ENVIRONMENT_LIGHT
    light += escaped_light(direction, transmittance);
#endif
    sum.light += local.weight * light;
}
