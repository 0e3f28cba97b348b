// Filters accumulated ray samples spatially over neighbours on the same surface. In: G-buffer,
// sums. Out: means. SPECULAR_LOBE 0: irradiance; 1: specular radiance, which smooth surfaces keep
// unfiltered.
#include "lib/gbuffer.glsl"
#include "lib/ray_accumulation.glsl"
#include "lib/specular_classify.glsl"

layout(local_size_x = PIXEL_GROUP_WIDTH, local_size_y = PIXEL_GROUP_HEIGHT) in;

// Below the first roughness neighbours reflect different things, above the second about the same.
const vec2 FILTERED_ROUGHNESS = vec2(0.1, 0.4);

void main()
{
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
    ivec2 size = ivec2(accumulation_size());
    if (any(greaterThanEqual(texel, size)))
        return;
    const uint FROM = SPECULAR_LOBE != 0 ? PLANE_SPECULAR : PLANE_DIFFUSE;
    const uint TO = SPECULAR_LOBE != 0 ? PLANE_SPECULAR_MEAN : PLANE_DIFFUSE_MEAN;
    surface s = gbuffer_load(uvec2(texel * GATHER_STEP));
    float pixel_m = accumulation_spacing_m(s);
    float others = 1.0;
#if SPECULAR_LOBE
    others = smoothstep(FILTERED_ROUGHNESS.x, FILTERED_ROUGHNESS.y, s.roughness);
#endif
    vec4 sum = former_sum(accumulation_index(FROM, uvec2(texel)));
    float weight = 1.0;
    for (int y = -2; y <= 2; y++)
        for (int x = -2; x <= 2; x++) {
            ivec2 other = texel + ivec2(x, y);
            if ((x == 0 && y == 0) || any(lessThan(other, ivec2(0))) ||
                any(greaterThanEqual(other, size)))
                continue;
            surface n = gbuffer_load(uvec2(other * GATHER_STEP));
            float w = others * likeness(s, n, pixel_m) * window_weight(x, y);
            if (w <= 0.0 || (SPECULAR_LOBE != 0 && !needs_specular_trace(n)))
                continue;
            sum += w * former_sum(accumulation_index(FROM, uvec2(other)));
            weight += w;
        }
#if SPECULAR_LOBE
    vec4 mean = vec4(sum.rgb / max(sum.a, 1e-6), 1.0);
#else
    vec4 mean = sum / (weight * voxels.sample_count);
#endif
    accumulated[accumulation_index(TO, uvec2(texel))] = mean;
}
