// Irradiance from the hemisphere's cones.
#include "lib/cone.glsl"
#if ENVIRONMENT_LIGHT
#include "lib/environment.glsl"
#endif

// Which of the two sets of cones: the cache's, or that of pixels.
#if PIXEL_CONES
#define MARCH voxels.pixel_march
#define CONES voxels.pixel_cones
#else
#define MARCH voxels.march
#define CONES voxels.cones
#endif

// Roughness whose lobe is about as wide as a cone, for the environment's filtered levels.
const float GATHER_ROUGHNESS = 0.5;

struct gathered {
    vec3 light; // irradiance / pi, in units of the volume's scale
    float openness;
};

// Gathers over the cones about `normal`, turned by the angle whose cosine and sine are `turn`.
gathered gather_diffuse(vec3 position_world, vec3 normal, vec2 turn)
{
    gathered sum;
    sum.light = vec3(0.0);
    sum.openness = 0.0;
    mat3 axes = frame_about(normal);
    vec3 tangent = axes[0] * turn.x + axes[1] * turn.y;
    vec3 bitangent = axes[1] * turn.x - axes[0] * turn.y;
    float voxel = voxels.levels[0].size.x;
    vec3 origin = voxel_position(position_world);
    for (uint level = 0u; level + 1u < voxels.counts.x && inside_level(level, origin) < 0.0; level++)
        voxel = voxels.levels[level + 1u].size.x;
    cone c;
    c.origin = origin + normal * (MARCH.y * voxel);
    c.tangent = MARCH.w;
    c.step = MARCH.x;
    c.reach_m = 1e30;
    for (uint i = 0u; i < uint(MARCH.z); i++) {
        vec4 local = CONES[i];
        c.direction = tangent * local.x + bitangent * local.y + normal * local.z;
        cone_light found = trace_cone(c, voxels.light.x);
        vec3 light = found.light;
#if ENVIRONMENT_LIGHT
        light += environment_specular(c.direction, GATHER_ROUGHNESS) *
                 (found.transmittance / voxels.anchor.w);
#endif
        sum.light += local.w * light;
        sum.openness += local.w * (1.0 - found.occlusion);
    }
    return sum;
}
