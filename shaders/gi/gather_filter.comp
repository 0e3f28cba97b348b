// Averages what rays from pixels have found over the neighbours that lie on the same surface. In:
// G-buffer, sums. Out: means. GLOSS 0: irradiance; 1: what lobes mirror, where smooth surfaces keep
// their own.
#include "lib/gbuffer.glsl"
#include "lib/gathered.glsl"
#include "lib/gloss_rule.glsl"

layout(local_size_x = GROUP_EDGE, local_size_y = GROUP_EDGE) in;

// From the first roughness on neighbours mirror something else, from the second about the same.
const vec2 FILTERED_ROUGHNESS = vec2(0.1, 0.4);

void main()
{
    ivec2 place = ivec2(gl_GlobalInvocationID.xy);
    ivec2 size = ivec2(gathered_size());
    if (any(greaterThanEqual(place, size)))
        return;
    const uint FROM = GLOSS != 0 ? GATHERED_GLOSS : GATHERED_LIGHT;
    const uint TO = GLOSS != 0 ? GATHERED_GLOSS_MEANS : GATHERED_LIGHT_MEANS;
    surface s = gbuffer_load(uvec2(place * GATHER_STEP));
    float pixel_m = gathered_pixel_m(s);
    float others = 1.0;
#if GLOSS
    others = smoothstep(FILTERED_ROUGHNESS.x, FILTERED_ROUGHNESS.y, s.roughness);
#endif
    vec4 sum = gathered_light[gathered_at(FROM, uvec2(place))];
    float weight = 1.0;
    for (int y = -2; y <= 2; y++)
        for (int x = -2; x <= 2; x++) {
            ivec2 other = place + ivec2(x, y);
            if ((x == 0 && y == 0) || any(lessThan(other, ivec2(0))) ||
                any(greaterThanEqual(other, size)))
                continue;
            surface n = gbuffer_load(uvec2(other * GATHER_STEP));
            float w = others * likeness(s, n, pixel_m) * window_weight(x, y);
            if (w <= 0.0 || (GLOSS != 0 && !deserves_cone(n)))
                continue;
            sum += w * gathered_light[gathered_at(FROM, uvec2(other))];
            weight += w;
        }
#if GLOSS
    vec4 mean = vec4(sum.rgb / max(sum.a, 1e-6), 1.0);
#else
    vec4 mean = sum / (weight * voxels.sample_count);
#endif
    gathered_light[gathered_at(TO, uvec2(place))] = mean;
}
