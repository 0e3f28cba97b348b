#include "renderer/path_tracer/lights.h"

#include <stdlib.h>
#include <string.h>

#include "renderer/path_tracer/light_grid.h"
#include "shared/frame_block.h"

// With more lights, a grid finds those that reach a point.
#define FEW_PUNCTUALS 8u
// Without a grid, so many candidates are drawn by power before one is chosen.
#define MAX_CANDIDATES 64u
// With so few emitters one random number has enough bits for the emitter and the point on it.
#define FEW_EMITTERS 32u
// Below this cosine an emitter has no solid angle.
#define MIN_EMITTER_COSINE 1e-6f

struct punctual {
    float3 position;
    float3 direction; // unit, of the spot or directional light
    float3 intensity; // cd or lux
    enum scene_light_type type;
    bool casts_shadow;
    float range_m;
    float cone_scale, cone_offset;
    float min_squared; // squared distance below which the inverse square is clamped
    float radius_m;
    float power_end; // cumulative luminance over that of all lights
};

struct emitter {
    float3 corner, edges[2];
    float3 normal;   // unit, of the front
    float3 radiance; // if uniform
    bool both_sides;
    bool is_even;   // false: evaluate the surface
    float per_area; // density of sampling a point, per square metre
    struct ray_crossing crossing;
};

struct lights {
    struct punctual *punctuals;
    uint32_t punctual_count;
    struct light_grid grid; // of punctual lights
    struct emitter *emitters;
    float *power_ends; // per emitter: cumulative fraction of power
    uint32_t emitter_count;
    double power; // area times luminance
    float inverse_power;
};

static void add_punctual(struct lights *lights, const struct snapshot *snapshot, uint32_t id)
{
    const struct scene_light *light = &snapshot->scene->lights[id];
    float position[3], direction[3];
    scene_get_light_placement(snapshot->scene, id, position, direction);
    float inner = cosf(light->inner_cone_rad), outer = cosf(light->outer_cone_rad);
    bool directional = light->type == SCENE_LIGHT_DIRECTIONAL;
    float scale = 1.0f / max1(0.001f, inner - outer);
    float min_m = fminf(LIGHT_MIN_DISTANCE_FRACTION * snapshot->diagonal_m, LIGHT_MIN_DISTANCE_M);
    lights->punctuals[lights->punctual_count++] = (struct punctual){
        .position = load3(position),
        .direction = load3(direction),
        .intensity = load3(light->color) * light->intensity,
        .type = light->type,
        .casts_shadow = light->casts_shadow,
        .range_m = directional ? 0.0f : light->range_m,
        .cone_scale = scale,
        .cone_offset = -outer * scale,
        .min_squared = min_m * min_m,
        .radius_m = directional ? 0.0f : light->radius_m,
    };
}

static bool make_grid(struct lights *lights, const struct scene *scene)
{
    double low[3] = {0}, high[3] = {0};
    float3 from = splat3(0.0f), to = splat3(0.0f);
    scene_bounds(scene, low, high);
    struct light_reach *reaches =
        aligned_alloc(16, lights->punctual_count * sizeof(struct light_reach));
    if (!reaches)
        return false;
    for (uint32_t i = 0; i < lights->punctual_count; i++)
        reaches[i] =
            (struct light_reach){lights->punctuals[i].position, lights->punctuals[i].range_m};
    for (int axis = 0; axis < 3; axis++) {
        from[axis] = (float)low[axis];
        to[axis] = (float)high[axis];
    }
    bool done = light_grid_init(&lights->grid, from, to, reaches, lights->punctual_count);
    free(reaches);
    return done;
}

static bool find_punctuals(struct lights *lights, const struct snapshot *snapshot)
{
    const struct scene *scene = snapshot->scene;
    lights->punctuals = aligned_alloc(16, (scene->light_count + 1) * sizeof(struct punctual));
    if (!lights->punctuals)
        return false;
    for (uint32_t i = 0; i < scene->light_count; i++) {
        const struct scene_light *light = &scene->lights[i];
        if (light->enabled && !light->removed && light->intensity > 0.0f &&
            max3(load3(light->color)) > 0.0f && scene->nodes[light->node].world_visible)
            add_punctual(lights, snapshot, i);
    }
    double total = 0.0, sum = 0.0;
    for (uint32_t i = 0; i < lights->punctual_count; i++)
        total += (double)luminance3(lights->punctuals[i].intensity);
    for (uint32_t i = 0; i < lights->punctual_count; i++) {
        sum += (double)luminance3(lights->punctuals[i].intensity);
        lights->punctuals[i].power_end = (float)(sum / total);
    }
    return lights->punctual_count <= FEW_PUNCTUALS || make_grid(lights, scene);
}

// False if the triangle has no area.
static bool emitter_init(struct emitter *emitter, const struct snapshot *snapshot, uint32_t node,
                         uint32_t primitive, uint32_t triangle)
{
    const struct material *material = snapshot_material(snapshot, primitive);
    const uint32_t *indices = snapshot_triangle(snapshot, primitive, triangle);
    float3 corners[3];
    for (int i = 0; i < 3; i++)
        corners[i] = instance_point(&snapshot->instances[node],
                                    load3(snapshot->scene->vertices[indices[i]].position));
    *emitter = (struct emitter){
        .corner = corners[0],
        .edges = {corners[1] - corners[0], corners[2] - corners[0]},
        .radiance = material->emission,
        .both_sides = material->double_sided,
        .is_even = !(material->texture_mask & 1u << SCENE_TEXTURE_EMISSIVE) && !material->masked &&
                   !material->blends,
        .crossing = {.node = node, .primitive = primitive, .triangle = triangle},
    };
    float3 normal = cross3(emitter->edges[0], emitter->edges[1]);
    emitter->normal = normalize3(snapshot->instances[node].mirrored ? -normal : normal);
    float squared = dot3(normal, normal);
    return squared > 0.0f && isfinite(squared);
}

static double emitter_power(const struct emitter *emitter, const struct material *material)
{
    return 0.5 * (double)length3(cross3(emitter->edges[0], emitter->edges[1])) *
           (double)material->emitted_luminance;
}

// Counts the emissive triangles of a primitive and, if there is a list, writes them from `first`
// on.
static uint32_t visit_primitive(struct lights *lights, const struct snapshot *snapshot,
                                uint32_t node, uint32_t primitive, uint32_t first)
{
    const struct material *material = snapshot_material(snapshot, primitive);
    uint32_t triangles =
                 material->emits ? snapshot->scene->primitives[primitive].index_count / 3 : 0,
             count = 0;
    for (uint32_t i = 0; i < triangles; i++) {
        struct emitter emitter;
        if (!emitter_init(&emitter, snapshot, node, primitive, i))
            continue;
        if (lights->emitters) {
            lights->power += emitter_power(&emitter, material);
            lights->emitters[first + count] = emitter;
        }
        count++;
    }
    return count;
}

static uint32_t visit_emitters(struct lights *lights, const struct snapshot *snapshot)
{
    const struct scene *scene = snapshot->scene;
    uint32_t count = 0;
    for (uint32_t node = 0; node < scene->node_count; node++) {
        const struct scene_node *source = &scene->nodes[node];
        if (source->mesh == SCENE_NONE || !source->world_visible || source->removed)
            continue;
        const struct scene_mesh *mesh = &scene->meshes[source->mesh];
        for (uint32_t i = 0; i < mesh->primitive_count; i++)
            count += visit_primitive(lights, snapshot, node, mesh->primitive_first + i, count);
    }
    return count;
}

static bool find_emitters(struct lights *lights, const struct snapshot *snapshot)
{
    uint32_t count = visit_emitters(lights, snapshot);
    lights->emitters = aligned_alloc(16, (count + 1) * sizeof(struct emitter));
    lights->power_ends = malloc((count + 1) * sizeof(float));
    if (!lights->emitters || !lights->power_ends)
        return false;
    visit_emitters(lights, snapshot);
    double sum = 0.0;
    lights->inverse_power = (float)(1.0 / lights->power);
    for (uint32_t i = 0; i < count; i++) {
        struct emitter *emitter = &lights->emitters[i];
        const struct material *material = snapshot_material(snapshot, emitter->crossing.primitive);
        sum += emitter_power(emitter, material);
        lights->power_ends[i] = (float)(sum / lights->power);
        emitter->per_area = material->emitted_luminance * lights->inverse_power;
    }
    lights->emitter_count = isfinite(lights->power) && lights->power > 0.0 ? count : 0;
    return true;
}

struct lights *lights_create(const struct snapshot *snapshot)
{
    struct lights *lights = calloc(1, sizeof(*lights));
    if (lights && !(find_punctuals(lights, snapshot) && find_emitters(lights, snapshot)))
        lights_destroy(&lights);
    return lights;
}

void lights_destroy(struct lights **lights)
{
    if (*lights) {
        free((*lights)->punctuals);
        light_grid_finish(&(*lights)->grid);
        free((*lights)->emitters);
        free((*lights)->power_ends);
    }
    free(*lights);
    *lights = NULL;
}

bool lights_have_punctual(const struct lights *lights)
{
    return lights->punctual_count > 0;
}

bool lights_have_emitters(const struct lights *lights)
{
    return lights->emitter_count > 0;
}

bool lights_are_few(const struct lights *lights)
{
    return lights->emitter_count <= FEW_EMITTERS;
}

static float spot_falloff(const struct punctual *light, float3 to_light)
{
    if (light->type != SCENE_LIGHT_SPOT)
        return 1.0f;
    float angular =
        clamp01(-dot3(light->direction, to_light) * light->cone_scale + light->cone_offset);
    return angular * angular;
}

// KHR_lights_punctual: inverse square, range window, spot cone. Ignores `radius_m`.
static bool evaluate_punctual(const struct punctual *light, float3 position,
                              struct light_sample *out_sample)
{
    out_sample->casts_shadow = light->casts_shadow;
    if (light->type == SCENE_LIGHT_DIRECTIONAL) {
        out_sample->distance = INFINITY;
        out_sample->direction = -light->direction;
        out_sample->light = light->intensity;
        return true;
    }
    float3 to_light = light->position - position;
    float squared = dot3(to_light, to_light), range2 = light->range_m * light->range_m;
    if (!(squared > 0.0f) || (range2 > 0.0f && squared >= range2))
        return false;
    out_sample->distance = sqrtf(squared);
    out_sample->direction = to_light * (1.0f / out_sample->distance);
    float strength = 1.0f / max1(squared, light->min_squared);
    if (light->range_m > 0.0f) {
        float ratio = squared / range2;
        strength *= clamp01(1.0f - ratio * ratio);
    }
    strength *= spot_falloff(light, out_sample->direction);
    out_sample->light = light->intensity * strength;
    return strength > 0.0f;
}

// Moves the sample from a light's centre to a random point of its sphere, uniform in solid angle,
// at the brightness that the point light has from afar. Unchanged inside the sphere.
static void spread_over_sphere(const struct punctual *light, const float u[2],
                               struct light_sample *sample)
{
    float sine2 = light->radius_m * light->radius_m / (sample->distance * sample->distance);
    if (!(light->radius_m > 0.0f) || sine2 >= 1.0f)
        return;
    // Radiance intensity / (pi r^2) over the cone's solid angle 2 pi (1 - cos).
    float cone = sine2 / (1.0f + sqrtf(1.0f - sine2)); // 1 - cosine without cancellation
    float brighter = 2.0f * cone / sine2;
    float lower = u[0] * cone, cosine = 1.0f - lower;
    float sine = sqrtf(max1(lower * (2.0f - lower), 0.0f)), angle = 2.0f * (float)M_PI * u[1];
    float3 x, y, middle = sample->direction;
    basis3(middle, &x, &y);
    float before = spot_falloff(light, middle);
    sample->direction = x * (sine * cosf(angle)) + y * (sine * sinf(angle)) + middle * cosine;
    sample->light *=
        brighter * (before > 0.0f ? spot_falloff(light, sample->direction) / before : 0.0f);
    float inside =
        max1(light->radius_m * light->radius_m - sample->distance * sample->distance * sine * sine,
             0.0f);
    sample->distance = sample->distance * cosine - sqrtf(inside);
}

// Index of the first of `count` cumulative fractions, `stride` floats apart, above `u`.
static uint32_t find_fraction(const float *ends, size_t stride, uint32_t count, float u)
{
    // Binary search without branches, which would be mispredicted.
    uint32_t first = 0, left = count;
    while (left > 1) {
        uint32_t half = left / 2;
        first += ends[(first + half - 1) * stride] > u ? 0 : half;
        left -= half;
    }
    return first;
}

// Weight of a light: about its unshadowed contribution.
static float choice_weight(const struct punctual *light, const struct light_sample *sample,
                           float3 normal, bool both_sides)
{
    if (light->radius_m > 0.0f) // part of the sphere may be visible though its centre is not
        return luminance3(sample->light);
    float cosine = dot3(normal, sample->direction);
    return luminance3(sample->light) * (both_sides ? fabsf(cosine) : max1(cosine, 0.0f));
}

// One candidate of many lights, evenly spaced in their cumulative power. Returns how many lights it
// stands for.
static uint32_t pick_candidate(const struct lights *lights, uint32_t number, float offset,
                               float *out_scale)
{
    float u = ((float)number + offset) / (float)MAX_CANDIDATES;
    uint32_t id = find_fraction(&lights->punctuals[0].power_end,
                                sizeof(struct punctual) / sizeof(float), lights->punctual_count, u);
    float begin = id > 0 ? lights->punctuals[id - 1].power_end : 0.0f;
    float fraction = max1(lights->punctuals[id].power_end - begin, 1e-30f);
    *out_scale = 1.0f / (fraction * (float)MAX_CANDIDATES);
    return id;
}

bool lights_sample_punctual(const struct lights *lights, float3 position, float3 normal,
                            bool both_sides, const float choice[2], const float u[2],
                            struct light_sample *out_sample)
{
    // Reservoir sampling: each light replaces the chosen one with probability weight over weight so
    // far. With many lights only visits those that reach here, or candidates that stand for the
    // others (Talbot et al. 2005, "Importance Resampling for Global Illumination").
    const uint32_t *near = NULL;
    uint32_t candidates = lights->punctual_count, chosen = UINT32_MAX;
    bool located = light_grid_find(&lights->grid, position, &near, &candidates);
    bool many = !located && candidates > MAX_CANDIDATES;
    candidates = many ? MAX_CANDIDATES : candidates;
    float total = 0.0f, chosen_weight = 0.0f, left = choice[0];
    for (uint32_t i = 0; i < candidates; i++) {
        float scale = 1.0f;
        uint32_t id = many ? pick_candidate(lights, i, choice[1], &scale) : located ? near[i] : i;
        struct light_sample sample = {0};
        if (!evaluate_punctual(&lights->punctuals[id], position, &sample))
            continue;
        float weight = choice_weight(&lights->punctuals[id], &sample, normal, both_sides);
        if (!(weight > 0.0f))
            continue;
        total += weight * scale;
        float fraction = weight * scale / total;
        if (left < fraction) {
            *out_sample = sample;
            chosen = id;
            chosen_weight = weight;
            left /= fraction;
        } else {
            left = (left - fraction) / (1.0f - fraction);
        }
    }
    if (chosen == UINT32_MAX)
        return false;
    out_sample->light *= total / chosen_weight;
    spread_over_sphere(&lights->punctuals[chosen], u, out_sample);
    return true;
}

float lights_emitter_density(const struct lights *lights, const struct surface *emitter,
                             float3 from)
{
    if (lights->emitter_count == 0)
        return 0.0f;
    float3 to_emitter = emitter->position - from;
    float squared = dot3(to_emitter, to_emitter);
    float cosine = -dot3(emitter->geometric_normal, to_emitter) / sqrtf(squared);
    if (!(cosine > MIN_EMITTER_COSINE))
        return 0.0f;
    return emitter->material->emitted_luminance * lights->inverse_power * squared / cosine;
}

bool lights_sample_emitter(const struct lights *lights, const struct snapshot *snapshot,
                           float3 position, float choice, const float u[2],
                           struct light_sample *out_sample)
{
    uint32_t id = find_fraction(lights->power_ends, 1, lights->emitter_count, choice);
    const struct emitter *emitter = &lights->emitters[id];
    float first = u[0];
    if (lights_are_few(lights)) {
        float begin = id > 0 ? lights->power_ends[id - 1] : 0.0f;
        first = clamp01((choice - begin) / (lights->power_ends[id] - begin));
    }
    float root = sqrtf(first), b = root * (1.0f - u[1]), c = root * u[1];
    float3 to_emitter = emitter->corner + emitter->edges[0] * b + emitter->edges[1] * c - position;
    float squared = dot3(to_emitter, to_emitter), nearness = 1.0f / sqrtf(squared);
    float3 direction = to_emitter * nearness;
    float cosine = -dot3(emitter->normal, direction);
    if (emitter->both_sides)
        cosine = fabsf(cosine);
    if (!(cosine > MIN_EMITTER_COSINE))
        return false;
    *out_sample = (struct light_sample){
        .direction = direction,
        .distance = squared * nearness,
        .light = emitter->radiance,
        .lift = dot3(emitter->normal, direction) > 0.0f ? -emitter->normal : emitter->normal,
        .span = span3(emitter->edges[0], emitter->edges[1]),
        .density = emitter->per_area * squared / cosine,
        .casts_shadow = true,
    };
    if (emitter->is_even)
        return true;
    struct ray_crossing crossing = emitter->crossing;
    struct surface surface;
    crossing.barycentric[0] = b;
    crossing.barycentric[1] = c;
    if (!surface_init(&surface, snapshot, &crossing, direction) || surface_is_hole(&surface))
        return false;
    out_sample->light = surface.emission * surface.coverage;
    return max3(out_sample->light) > 0.0f;
}
