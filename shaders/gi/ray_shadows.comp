// Traces the visibility of area and sphere lights at pixels: per frame one ray to a point on each
// light, from one pixel of each GATHER_STEP x GATHER_STEP in turn. In: G-buffer, BVH, lights. Out:
// sums over the frames in which nothing moved.
#include "lib/gbuffer.glsl"
#include "lib/ray_accumulation.glsl"
#include "lib/bvh.glsl"
#include "lib/lighting.glsl"
#include "lib/ray_sequence.glsl"

layout(local_size_x = PIXEL_GROUP_WIDTH, local_size_y = PIXEL_GROUP_HEIGHT) in;

// Rays end just before the light.
const float REACH = 0.999;
// Step of the sequence from light to light (Roberts 2018, as ray_sequence.glsl).
const vec3 NEXT_LIGHT = vec3(0.8191725, 0.6710436, 0.5497005);

struct light_sum {
    vec3 whole; // unshadowed
    vec3 seen;
};

void add_light(inout light_sum sum, surface s, vec3 light, vec3 texel, float chance)
{
    if (max(light.r, max(light.g, light.b)) <= 0.0)
        return;
    vec3 origin = offset_ray_origin(s.position, s.geometric_normal);
    vec3 to_light = texel - frame.bvh_origin - origin;
    sum.whole += light;
    if (closest_hit(origin, to_light, REACH, chance).triangle == BVH_LEAF)
        sum.seen += light;
}

#if AREA_LIGHTS
// Samples a point on an emitter by its contribution to the surface: one of four candidates, one per
// quarter (resampled importance sampling, Talbot et al. 2005).
vec3 point_on(area_light_block light, surface s, vec3 u)
{
    vec3 points[4];
    float weights[4];
    float sum = 0.0;
    for (int i = 0; i < 4; i++) {
        vec2 at = 0.5 * (u.xy + vec2(i & 1, i >> 1));
        points[i] = mix(mix(light.corners[0].xyz, light.corners[1].xyz, at.x),
                        mix(light.corners[3].xyz, light.corners[2].xyz, at.x), at.y);
        vec3 to_light = points[i] - s.position;
        float squared = max(dot(to_light, to_light), 1e-30);
        weights[i] = max(dot(to_light, s.normal), 0.0) * abs(dot(to_light, light.normal)) /
                     (squared * squared);
        sum += weights[i];
    }
    int chosen = 0;
    float left = u.z * sum;
    while (chosen < 3 && left >= weights[chosen])
        left -= weights[chosen++];
    return points[chosen];
}
#endif

vec3 light_visibility(surface s, vec3 u)
{
    light_sum sum = light_sum(vec3(0.0), vec3(0.0));
#if PUNCTUAL_LIGHTS
    uint i = 0u;
    if (i < frame.light_count) {
        do {
            light_block light = load_light(i);
            if (!has_size(light))
                continue;
            // A sphere light, sampled as the disk that faces the surface.
            vec3 l;
            vec3 unshadowed = punctual_unshadowed(s, light, l);
            float angle = 2.0 * PI * u.y;
            vec3 offset = frame_about(l) * vec3(cos(angle), sin(angle), 0.0);
            vec3 texel = light.position + offset * (sqrt(u.x) * light.radius_m);
            add_light(sum, s, unshadowed, texel, u.z);
            u = fract(u + NEXT_LIGHT);
        } while (++i < frame.light_count);
    }
#endif
#if AREA_LIGHTS
    uint j = 0u;
    if (j < frame.area_light_count) {
        do {
            area_light_block light = load_area_light(j);
            if (light.shadow.first_view == NO_SHADOW)
                continue;
            add_light(sum, s, area_unshadowed(s, light), point_on(light, s, u), fract(16.0 * u.z));
            u = fract(u + NEXT_LIGHT);
        } while (++j < frame.area_light_count);
    }
#endif
    return mix(vec3(1.0), sum.seen / max(sum.whole, vec3(1e-30)),
               greaterThan(sum.whole, vec3(0.0)));
}

void main()
{
    uvec2 texel = gl_GlobalInvocationID.xy;
    if (any(greaterThanEqual(texel, accumulation_size())))
        return;
    const uint STEP = uint(GATHER_STEP);
    uint picture = uint(voxels.sample_count) - 1u;
    uint turn = picture % (STEP * STEP);
    if (picture == 0u)
        for (uint i = 0u; i < uint(GATHER_STEP * GATHER_STEP); i++) {
            uvec2 other = texel * STEP + uvec2(i % STEP, i / STEP);
            if (all(lessThan(other, frame.render_size)))
                accumulated[visibility_index(other)] = vec4(0.0);
        }
    uvec2 pixel = texel * STEP + uvec2(turn % STEP, turn / STEP);
    if (any(greaterThanEqual(pixel, frame.render_size)))
        return;
    surface s = gbuffer_load(pixel);
    if (s.shading >= SHADE_UNLIT)
        return;
    uint at = visibility_index(pixel);
    accumulated[at] = (picture == 0u ? vec4(0.0) : former_sum(at)) +
                      vec4(light_visibility(s, ray_numbers(pixel, picture / (STEP * STEP))), 1.0);
}
