// Direct light from punctual lights (KHR_lights_punctual) and area lights.
#include "lib/brdf.glsl"
#include "lib/cone.glsl"
#include "lib/light_table.glsl"
// Last, since files are included once: what it includes is here already.
#if SHADOWS
#include "lib/shadow.glsl"
#endif

#if LIGHT_TILES
// frame.light_mask_words words per tile, one bit per light
layout(binding = UNIT_LIGHT_MASKS) uniform usamplerBuffer light_masks;
#endif

#if RAY_SHADOWS
// Traced visibility of area and sphere lights; set by the caller.
vec3 traced_visibility = vec3(1.0);
#elif CONE_SHADOWS
// Visibility of an area or sphere light by a cone towards it; `hard` is the shadow map's for its
// centre. Voxels miss occluders nearer than a voxel, but penumbrae narrower than a voxel come from
// the map anyway.
float soft_visibility(float hard, surface s, vec3 to_light, float distance_m, float radius_m)
{
    vec3 normal = s.geometric_normal;
    vec3 origin = voxel_position(s.position);
    float voxel = finest_voxel(origin);
    float start = cone_start(voxels.pixel_march.start_voxels, s.thin, normal);
    cone c;
    c.origin = origin + normal * (start * voxel);
    c.direction = to_light;
    c.tangent = max(radius_m / max(distance_m, 1e-6), 1e-3);
    c.step = 1.0;
    c.widest = voxels.cone_max_diameter_m;
    // Ends before the voxels around the light, however wide the cone is there.
    c.reach_m = (distance_m - (start + 2.0) * voxel) / (1.0 + 3.0 * c.tangent);
    cone_light found = trace_cone(c, 1.0);
    float penumbra = radius_m * found.hit_m / max(distance_m - found.hit_m, 1e-6);
    float fraction = found.transmittance < 0.99 ? smoothstep(1.0, 3.0, penumbra / voxel) : 0.0;
    // Excludes the stair steps of the surface's own voxels.
    fraction *= smoothstep(1.0, 3.0, dot(to_light, normal) * found.hit_m / voxel);
    return mix(hard, found.transmittance, fraction);
}
#endif

#if PUNCTUAL_LIGHTS
float distance_attenuation(float squared, float range_m)
{
    float attenuation = 1.0 / max(squared, frame.light_min_distance2);
    if (range_m > 0.0) {
        float ratio = squared / (range_m * range_m);
        attenuation *= clamp(1.0 - ratio * ratio, 0.0, 1.0);
    }
    return attenuation;
}

// Unshadowed radiance towards the viewer from a light; `l` is the direction to it.
vec3 punctual_unshadowed(surface s, light_block light, out vec3 l)
{
    l = -light.direction;
    float strength = 1.0;
    if (light.type != LIGHT_DIRECTIONAL) {
        vec3 to_light = light.position - s.position;
        float squared = dot(to_light, to_light);
        l = safe_normalize(to_light, s.normal);
        strength = distance_attenuation(squared, light.range_m);
        if (light.type == LIGHT_SPOT) {
            float cosine = dot(light.direction, -l);
            float angular = clamp(cosine * light.cone_scale + light.cone_offset, 0.0, 1.0);
            strength *= angular * angular;
        }
    }
    if (strength <= 0.0 || dot(s.normal, l) <= 0.0 || dot(s.geometric_normal, l) <= 0.0)
        return vec3(0.0);
    return brdf_cosine(s, l) * light.intensity * strength;
}

// Whether the light casts soft shadows.
bool has_size(light_block light)
{
    return light.radius_m > 0.0 && light.type != LIGHT_DIRECTIONAL &&
           light.shadow.first_view != NO_SHADOW;
}

vec3 punctual_light(surface s, light_block light)
{
    vec3 l;
    vec3 reflected = punctual_unshadowed(s, light, l);
#if SHADOWS
    if (max(reflected.r, max(reflected.g, reflected.b)) <= 0.0)
        return vec3(0.0);
#if RAY_SHADOWS
    if (has_size(light))
        return reflected * traced_visibility;
#endif
    float lit = shadow_visibility(light.shadow, light.position, s.position, s.geometric_normal, l);
#if CONE_SHADOWS
    if (has_size(light))
        lit = soft_visibility(lit, s, l, length(light.position - s.position), light.radius_m);
#endif
    reflected *= lit;
#endif
    return reflected;
}
#endif

#if AREA_LIGHTS
// Integral over one polygon edge as seen from the origin (Lambert 1760; Baum et al. 1989): the
// angle it spans times the unit normal of its plane, component along n. a and b are unit vectors.
// angle / sin(angle) by the rational fit of Hill and Heitz 2016, "Real-Time Area Lighting: a
// Journey from Research to Production".
float edge_integral(vec3 a, vec3 b, vec3 n)
{
    float x = dot(a, b);
    float y = abs(x);
    float numerator = 0.8543985 + (0.4965155 + 0.0145206 * y) * y;
    float denominator = 3.4175940 + (4.1616724 + y) * y;
    float fit = numerator / denominator;
    float angle_over_sine = x > 0.0 ? fit : 0.5 * inversesqrt(max(1.0 - x * x, 1e-7)) - fit;
    return dot(cross(a, b), n) * angle_over_sine;
}

// Form factor of a quad for a receiver at the origin with unit normal n, clipped to its horizon:
// irradiance = pi * radiance * form factor. Corners counter-clockwise seen from the lit side.
float quad_form_factor(vec3 corners[4], vec3 n)
{
    vec3 directions[4];
    float heights[4]; // sines of the elevation; what is at the horizon counts as below
    for (int i = 0; i < 4; i++) {
        directions[i] = safe_normalize(corners[i], n);
        float height = dot(directions[i], n);
        heights[i] = height > 1e-6 ? height : min(height, 0.0);
    }
    // A convex outline crosses the horizon once upwards and once downwards, if at all. The great
    // circle through two directions meets it at their mean weighted by each other's height.
    vec3 entry = n;
    vec3 leave = n;
    for (int i = 0; i < 4; i++) {
        int next = (i + 1) & 3;
        vec3 crossing = directions[i] * abs(heights[next]) + directions[next] * abs(heights[i]);
        entry = heights[i] <= 0.0 && heights[next] > 0.0 ? crossing : entry;
        leave = heights[i] > 0.0 && heights[next] <= 0.0 ? crossing : leave;
    }
    entry *= inversesqrt(max(dot(entry, entry), 1e-30));
    leave *= inversesqrt(max(dot(leave, leave), 1e-30));
    float sum = edge_integral(leave, entry, n); // the fit is of angle / (2 pi sine)
    for (int i = 0; i < 4; i++) {
        int next = (i + 1) & 3;
        bool above = heights[i] > 0.0;
        bool next_above = heights[next] > 0.0;
        vec3 from = above ? directions[i] : entry;
        vec3 to = next_above ? directions[next] : leave;
        sum += above || next_above ? edge_integral(from, to, n) : 0.0;
    }
    return sum;
}

#if SPECULAR
// Specular light of a planar emitter from its point nearest to the mirror ray, with the lobe
// widened by the emitter's extent (Karis 2013, "Real Shading in Unreal Engine 4").
vec3 area_specular(surface s, area_light_block light, vec3 corners[4], bool reversed)
{
    vec3 mirror = reflect(-s.view, s.normal);
    vec3 center = light.center - s.position;
    vec3 normal = reversed ? -light.normal : light.normal;
    float slope = dot(mirror, normal);
    vec3 target = center;
    if (slope < -1e-4)
        target = mirror * (dot(center, normal) / slope);
    // Nearest point of the parallelogram spanned at the first corner.
    vec3 u = corners[1] - corners[0];
    vec3 v = corners[3] - corners[0];
    vec3 d = target - corners[0];
    float uu = dot(u, u), uv = dot(u, v), vv = dot(v, v);
    float scale = 1.0 / max(uu * vv - uv * uv, 1e-30);
    vec2 at = clamp(vec2(vv * dot(d, u) - uv * dot(d, v), uu * dot(d, v) - uv * dot(d, u)) * scale,
                    0.0, 1.0);
    vec3 nearest = corners[0] + u * at.x + v * at.y;
    float squared = max(dot(nearest, nearest), frame.light_min_distance2);
    vec3 l = nearest * inversesqrt(squared);
    float cosine = max(-dot(l, normal), 0.0);
    float alpha = alpha_of(s);
    float solid_angle = min(light.area_m2 * cosine / squared, 2.0 * PI);
    // A lobe narrower than the emitter reflects radiance, not intensity: the widened lobe
    // integrates to at most one over the emitter.
    float widened = sqrt(alpha * alpha + solid_angle / (4.0 * PI));
    // At grazing angles widening is not enough; no surface reflects more than it receives.
    vec3 fraction = min(specular_brdf_cosine(s, l, min(widened, 1.0)) * solid_angle, 1.0);
    return fraction * light.radiance;
}

#endif

vec3 area_unshadowed(surface s, area_light_block light)
{
#if INDIRECT_DIFFUSE
    // Cones gather the light of large emitters.
    if (light.in_voxels != 0u)
        return vec3(0.0);
#endif
    float side = dot(light.normal, s.position - light.center);
    bool reversed = side < 0.0;
    if (reversed && light.two_sided == 0u)
        return vec3(0.0);
    vec3 corners[4];
    for (int i = 0; i < 4; i++)
        corners[i] = (reversed ? light.corners[3 - i].xyz : light.corners[i].xyz) - s.position;
    // A corner at the receiver has no direction; an emitter does not light itself.
    if (abs(side) < 1e-6 * sqrt(light.area_m2))
        return vec3(0.0);
    float form_factor = max(-quad_form_factor(corners, s.normal), 0.0);
    vec3 to_light = safe_normalize(light.center - s.position, s.normal);
    float v_h = clamp(dot(s.view, safe_normalize(to_light + s.view, s.normal)), 0.0, 1.0);
    vec3 reflected = diffuse_reflectance(s, v_h) * light.radiance * form_factor;
#if SPECULAR
    reflected += area_specular(s, light, corners, reversed);
#endif
    return reflected;
}

vec3 area_light(surface s, area_light_block light)
{
    vec3 reflected = area_unshadowed(s, light);
#if SHADOWS
    if (max(reflected.r, max(reflected.g, reflected.b)) <= 0.0)
        return vec3(0.0);
#if RAY_SHADOWS
    if (light.shadow.first_view != NO_SHADOW)
        return reflected * traced_visibility;
#endif
    vec3 to_light = safe_normalize(light.center - s.position, s.normal);
    float lit =
        shadow_visibility(light.shadow, light.center, s.position, s.geometric_normal, to_light);
#if CONE_SHADOWS
    // As a disk of the emitter's area, seen at its slant.
    float cosine = abs(dot(light.normal, to_light));
    if (light.shadow.first_view != NO_SHADOW)
        lit = soft_visibility(lit, s, to_light, length(light.center - s.position),
                              sqrt(light.area_m2 * cosine / PI));
#endif
    reflected *= lit;
#endif
    return reflected;
}
#endif

// Radiance towards the viewer from direct light, in cd/m^2.
vec3 direct_light(surface s, uvec2 pixel)
{
    vec3 sum = vec3(0.0);
#if PUNCTUAL_LIGHTS && LIGHT_TILES
    uint tile = (pixel.y / LIGHT_TILE_EDGE) * frame.tile_count.x + pixel.x / LIGHT_TILE_EDGE;
    uint word = 0u;
    do {
        uint mask = texelFetch(light_masks, int(tile * frame.light_mask_words + word)).x;
        if (mask != 0u) {
            do {
                sum += punctual_light(s, load_light(word * 32u + uint(findLSB(mask))));
            } while ((mask &= mask - 1u) != 0u);
        }
    } while (++word < frame.light_mask_words);
#elif PUNCTUAL_LIGHTS
    uint light = 0u;
    if (light < frame.light_count) {
        do {
            sum += punctual_light(s, load_light(light));
        } while (++light < frame.light_count);
    }
#endif
#if AREA_LIGHTS
    uint emitter = 0u;
    if (emitter < frame.area_light_count) {
        do {
            sum += area_light(s, load_area_light(emitter));
        } while (++emitter < frame.area_light_count);
    }
#endif
    return sum;
}
