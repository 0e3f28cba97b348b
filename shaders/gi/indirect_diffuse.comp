// Adds indirect diffuse light, or writes it alone (ALONE, a debug view). In: G-buffer; the
// irradiance cache (CACHED 1), or the accumulation of every pixel (GATHER_STEP 1) or of every
// second in x and y (2), as sums or as filtered means (FILTERED 1). Out: radiance in cd/m^2.
//
// From the cache, an invocation shades 2x2 pixels: irradiance varies little between them, so it is
// looked up once and again only for pixels on another surface.
#include "lib/ray_accumulation.glsl"
#include "lib/gbuffer.glsl"
#include "lib/cache_lookup.glsl"
#include "lib/indirect_reflect.glsl"
#include "lib/radiance_buffer.glsl"

layout(local_size_x = PIXEL_GROUP_WIDTH, local_size_y = PIXEL_GROUP_HEIGHT) in;

#if CACHED
// Two pixels share irradiance if normals and positions differ by no more than this.
const float SHARED_COSINE = 0.97;
const float SHARED_VOXELS = 0.3;

bool is_same_surface(vec3 normal, vec3 position, vec3 known_normal, vec3 known_position)
{
    return dot(normal, known_normal) > SHARED_COSINE &&
           abs(dot(position - known_position, known_normal)) <
               SHARED_VOXELS * voxels.levels[0].voxel_edge_m;
}

uvec2 pixel_of_four(uint number)
{
    return gl_GlobalInvocationID.xy * 2u + uvec2(number & 1u, number >> 1);
}

// Returns whether the pixel is in the image and lit, as its bit of four.
uint load_position(uint number, out vec3 position, out vec3 normal)
{
    uvec2 pixel = pixel_of_four(number);
    surface s = gbuffer_load(min(pixel, frame.render_size - 1u));
    position = s.position;
    normal = s.geometric_normal;
    bool inside = all(lessThan(pixel, frame.render_size));
    return inside && s.shading < SHADE_UNLIT ? 1u << number : 0u;
}

void shade(uint number, bool lit, vec4 light)
{
    uvec2 pixel = pixel_of_four(number);
#if ALONE
    bool written = all(lessThan(pixel, frame.render_size));
    vec3 before = vec3(0.0);
#else
    bool written = lit;
    vec3 before = former_radiance(pixel_index(pixel));
#endif
    if (!written)
        return;
    surface s = gbuffer_load(pixel);
    vec3 reflected = lit ? reflect_irradiance(s, light) : vec3(0.0);
    radiance[pixel_index(pixel)] = vec4(before + reflected, 1.0);
}

void main()
{
    vec3 positions[4];
    vec3 normals[4];
    uint lit =
        load_position(0u, positions[0], normals[0]) | load_position(1u, positions[1], normals[1]) |
        load_position(2u, positions[2], normals[2]) | load_position(3u, positions[3], normals[3]);
    // A look-up is the dear part. On a CPU this loop runs as often as the lane with the most
    // surfaces needs, mostly once; a branch in a loop over the pixels would run four times.
    vec4 light[4] = vec4[4](vec4(0.0), vec4(0.0), vec4(0.0), vec4(0.0));
    uint left = lit;
    if (left != 0u) {
        do {
            uint from = uint(findLSB(left));
            vec3 normal = normals[from];
            vec3 position = positions[from];
            vec4 known = cached_irradiance(position, normal);
            bool shared_light = true; // up to the first pixel on another surface
            for (uint i = 0u; i < 4u; i++) {
                bool waits = (left & (1u << i)) != 0u;
                shared_light =
                    shared_light && (!waits || i == from ||
                                     is_same_surface(normals[i], positions[i], normal, position));
                light[i] = waits && shared_light ? known : light[i];
                left &= shared_light ? ~(1u << i) : ~0u;
            }
        } while (left != 0u);
    }
    // No loop: a CPU driver keeps arrays in memory that a loop indexes.
    shade(0u, (lit & 1u) != 0u, light[0]);
    shade(1u, (lit & 2u) != 0u, light[1]);
    shade(2u, (lit & 4u) != 0u, light[2]);
    shade(3u, (lit & 8u) != 0u, light[3]);
}
#else
// Mean of a pixel's samples.
vec4 found_at(uvec2 texel)
{
#if FILTERED
    return former_sum(accumulation_index(PLANE_DIFFUSE_MEAN, texel));
#else
    return former_sum(accumulation_index(PLANE_DIFFUSE, texel)) / voxels.sample_count;
#endif
}

#if GATHER_STEP == 2
// Joint bilateral upsampling (Kopf et al. 2007): blends the four nearest gathered pixels by
// distance and by similarity of surface.
vec4 upsampled_light(surface s, uvec2 pixel)
{
    vec2 at = vec2(pixel) * 0.5;
    ivec2 low = ivec2(floor(at));
    vec2 t = at - vec2(low);
    vec4 sum = vec4(0.0);
    float weight = 0.0;
    for (int i = 0; i < 4; i++) {
        ivec2 step = ivec2(i & 1, i >> 1);
        ivec2 texel = min(low + step, ivec2(accumulation_size()) - 1);
        surface other = gbuffer_load(uvec2(texel) * 2u);
        if (other.shading >= SHADE_UNLIT)
            continue;
        vec2 near = mix(1.0 - t, t, vec2(step));
        float off = abs(dot(other.position - s.position, s.geometric_normal)) *
                    voxels.levels[0].inverse_voxel_edge;
        float cosine = max(dot(other.normal, s.normal), 0.0);
        float w = (near.x * near.y + 1e-3) * exp(-4.0 * off) * pow(cosine, 8.0) + 1e-7;
        sum += w * found_at(uvec2(texel));
        weight += w;
    }
    return weight > 0.0 ? sum / weight : vec4(0.0);
}
#endif

void main()
{
    uvec2 pixel = gl_GlobalInvocationID.xy;
    if (any(greaterThanEqual(pixel, frame.render_size)))
        return;
    uint at = pixel_index(pixel);
#if ALONE
    radiance[at] = vec4(0.0, 0.0, 0.0, 1.0);
    vec3 before = vec3(0.0);
#else
    vec3 before = former_radiance(at);
#endif
    surface s = gbuffer_load(pixel);
    if (s.shading >= SHADE_UNLIT)
        return;
#if GATHER_STEP == 2
    vec4 light = upsampled_light(s, pixel);
#else
    vec4 light = found_at(pixel);
#endif
    radiance[at] = vec4(before + reflect_irradiance(s, light), 1.0);
}
#endif
