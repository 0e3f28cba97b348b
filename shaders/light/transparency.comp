// Shades blended and transmissive layers over the opaque image, per pixel in depth order, in the
// tiles that hold any (one group each). In: tiles, fragment lists, geometry, materials, lights.
// Out: radiance in cd/m^2.
//
// A layer covers `alpha` of the pixel. Its diffuse part transmits the fraction `transmission`
// unscattered, tinted by base colour (KHR_materials_transmission, thin-walled) and absorbed along
// its thickness (KHR_materials_volume); its specular part reflects.
#include "lib/geometry.glsl"
#include "lib/lighting.glsl"
#include "lib/cache_lookup.glsl"
#include "lib/environment.glsl"
#include "lib/fragments.glsl"
#include "lib/specular_cone.glsl"
#include "lib/radiance_buffer.glsl"

layout(local_size_x = GROUP_EDGE, local_size_y = GROUP_EDGE) in;

// Collects the ids of a pixel's nearest layers, farthest first. Equal depths sort by id, so that
// the result does not depend on the order of fragments.
uint collect_layers(uvec2 pixel, out uint layers[MAX_BLENDED_LAYERS])
{
    float distances[MAX_BLENDED_LAYERS];
    uint count = 0u;
    vec3 direction = ray_direction(vec2(pixel));
    uint slot = fragment_word(head_index(pixel));
    if (slot == 0u)
        return 0u;
    do {
        uint base = fragment_index(slot - 1u);
        uint id = fragment_word(base + 1u);
        slot = fragment_word(base);
        triangle t = fetch_triangle(id, frame.eye);
        vec3 w = plane_weights(t, direction);
        float along = dot(frame.forward, t.corner + w.y * t.edges[0] + w.z * t.edges[1]);
        if (count == MAX_BLENDED_LAYERS) {
            if (along > distances[0] || (along == distances[0] && id > layers[0]))
                continue;
            for (uint i = 1u; i < MAX_BLENDED_LAYERS; i++) { // drops the farthest
                distances[i - 1u] = distances[i];
                layers[i - 1u] = layers[i];
            }
            count--;
        }
        uint at = count;
        bool nearer = true;
        do {
            nearer = at > 0u && (distances[at - 1u] < along ||
                                 (distances[at - 1u] == along && layers[at - 1u] < id));
            if (nearer) {
                distances[at] = distances[at - 1u];
                layers[at] = layers[at - 1u];
                at--;
            }
        } while (nearer);
        distances[at] = along;
        layers[at] = id;
        count++;
    } while (slot != 0u);
    return count;
}

vec3 transmittance(surface s, transparent_layer through)
{
    float n_v = clamp(dot(s.normal, s.view), 0.0, 1.0);
    vec3 kept = vec3(1.0) - fresnel_schlick(s.f0, vec3(s.f90), n_v);
    vec3 tint = s.base_color * kept * through.transmission;
    if (through.attenuation_distance_m > 0.0 && through.thickness_m > 0.0)
        tint *= pow(max(through.attenuation_color, vec3(1e-6)),
                    vec3(through.thickness_m / through.attenuation_distance_m));
    return vec3(1.0 - through.alpha) + through.alpha * tint;
}

vec3 transparent_layer_radiance(surface s, transparent_layer through, uvec2 pixel)
{
    if (s.shading == SHADE_UNLIT)
        return s.emission * through.alpha;
    vec3 sum = s.emission;
    // The transmitted fraction of the diffuse part does not reflect: reduces the base colour, but
    // not of the metallic part.
    s.base_color *= 1.0 - through.transmission * (1.0 - s.metallic);
#if PUNCTUAL_LIGHTS || AREA_LIGHTS
    sum += direct_light(s, pixel);
#endif
#if INDIRECT_DIFFUSE
    float n_v = clamp(dot(s.normal, s.view), 0.0, 1.0);
    vec3 diffuse = s.base_color * ((1.0 - s.metallic) * mean_diffuse_fraction(s, n_v));
    vec4 around = cached_irradiance(s.position, s.geometric_normal);
#if AMBIENT_OCCLUSION
    diffuse *= around.a;
#endif
    sum +=
        diffuse * around.rgb * (s.occlusion * voxels.radiance_scale * settings.indirect_intensity);
    vec3 mirror = reflect(-s.view, s.normal);
    vec2 scale_bias = environment_brdf(s.roughness, n_v);
    vec3 f0 = mix(s.f0, s.base_color, s.metallic);
    vec3 reflected = f0 * scale_bias.x + mix(s.f90, 1.0, s.metallic) * scale_bias.y;
    sum += reflected * trace_specular(s.position, s.geometric_normal, s.thin, mirror, s.roughness);
#elif ENVIRONMENT
    sum += environment_light(s);
#endif
    return sum * through.alpha;
}

#if REFRACTION
// Light through the volume below a surface, by one cone along the refracted ray, as wide as its
// roughness (KHR_materials_volume). Both faces of a slab refract alike, so the ray leaves in its
// original direction; on total internal reflection it is mirrored.
vec3 refracted_light(surface s, transparent_layer through)
{
    float ratio = 1.0 / max(through.ior, 1.0);
    vec3 inside = refract(-s.view, s.normal, ratio);
    if (dot(inside, inside) == 0.0)
        inside = reflect(-s.view, s.normal);
    // The transmission lobe narrows as the interface refracts less.
    float roughness = s.roughness * clamp(2.0 * (1.0 - ratio), 0.0, 1.0);
    vec3 leaving = s.position + inside * through.thickness_m;
    return trace_specular(leaving, -s.geometric_normal * 0.5, false, normalize(inside), roughness);
}
#endif

void main()
{
    uint tile = fragment_word(tile_index(gl_WorkGroupID.x));
    uvec2 pixel = uvec2(tile & 0xffffu, tile >> 16) * GROUP_EDGE + gl_LocalInvocationID.xy;
    if (any(greaterThanEqual(pixel, frame.render_size)))
        return;
    uint layers[MAX_BLENDED_LAYERS];
    uint count = collect_layers(pixel, layers);
    if (count == 0u)
        return;
    uint at = pixel.y * frame.render_size.x + pixel.x;
    vec3 sum = former_radiance(at);
    uint i = 0u;
    do {
        transparent_layer through;
        surface s = load_surface(layers[i], pixel_camera_ray(vec2(pixel)), through);
        vec3 behind = sum;
#if REFRACTION
        if (through.thickness_m > 0.0 && through.transmission > 0.0)
            behind = mix(sum, refracted_light(s, through), through.alpha);
#endif
        sum = behind * transmittance(s, through) + transparent_layer_radiance(s, through, pixel);
    } while (++i < count);
    radiance[at] = vec4(sum, 1.0);
}
