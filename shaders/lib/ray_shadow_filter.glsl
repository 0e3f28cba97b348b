// Filters the visibility that gi/ray_shadows.comp has traced, over neighbours on the same surface.
#include "lib/gbuffer.glsl"
#include "lib/ray_accumulation.glsl"

#if RAY_SHADOWS
// Rejects neighbours across a shadow's edge: those that differ by more than twice the noise of so
// few rays, whose variance is at most 1/4 over their number.
float same_shadow(vec4 a, vec4 b)
{
    vec3 difference = abs(a.rgb / a.a - b.rgb / b.a);
    float maximum = max(difference.r, max(difference.g, difference.b));
    return exp(-maximum * maximum / (1.0 / a.a + 1.0 / b.a));
}

// Visibility of area and sphere lights at a pixel. Neighbours are weighted by their number of rays,
// since sums are stored.
vec3 filtered_visibility(surface s, uvec2 pixel)
{
    vec4 own = former_sum(visibility_index(pixel));
    vec4 sum = own;
    float pixel_m = accumulation_spacing_m(s) / float(GATHER_STEP);
    for (int y = -2; y <= 2; y++)
        for (int x = -2; x <= 2; x++) {
            ivec2 other = ivec2(pixel) + ivec2(x, y);
            if ((x == 0 && y == 0) || any(lessThan(other, ivec2(0))) ||
                any(greaterThanEqual(other, ivec2(frame.render_size))))
                continue;
            vec4 value = former_sum(visibility_index(uvec2(other)));
            if (value.a == 0.0)
                continue;
            float w = likeness(s, gbuffer_load(uvec2(other)), pixel_m) * window_weight(x, y);
            sum += (own.a > 0.0 ? w * same_shadow(own, value) : w) * value;
        }
    return sum.a > 0.0 ? sum.rgb / sum.a : vec3(1.0);
}
#endif
