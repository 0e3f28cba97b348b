#include "renderer/reference/path.h"

#include <string.h>

#include "renderer/reference/bsdf.h"
#include "renderer/reference/environment.h"
#include "renderer/reference/lights.h"
#include "renderer/reference/sampler.h"

#define RAY_MAX_DISTANCE 1e15f
// Rays start this far off a surface: some units in the last place of its coordinates, and of those
// that its triangle spans.
#define OFFSET_OF_PLACE 2e-6f
#define OFFSET_OF_SPAN  4e-7f
// Surfaces that one ray may pass through, and vertices that a path may have, unlikely as they are.
#define MAX_LAYERS   64u
#define MAX_VERTICES 4096u
// Bodies within bodies.
#define MAX_MEDIA 4u
// Paths end by chance from here on, by how much light they still carry.
#define ROULETTE_FROM_VERTEX  3u
#define ROULETTE_MAX_SURVIVAL 0.95f
// Caustics of points: chance alone would never find a point by way of a mirror or a lens. So where
// a path has spread before, lobes towards points are at least this wide, less with each further
// sample of the pixel: the picture converges to the right one (Kaplanyan and Dachsbacher 2013,
// "Path Space Regularization for Holistic and Robust Light Transport").
#define CAUSTIC_ALPHA 0.2f
#define CAUSTIC_POWER (-1.0f / 6.0f)
// Per steradian; directions chosen by less spread a path.
#define SPREAD_DENSITY 10.0f
// What lets less than this through is opaque.
#define MIN_TRANSMITTANCE 1e-6f

// Random numbers of a vertex; see sampler.h.
enum use {
    USE_LAMP,
    USE_LAMP_POINT,
    USE_EMITTER,
    USE_EMITTER_POINT,
    USE_ENVIRONMENT,
    USE_LOBE,
    USE_DIRECTION,
    USE_ROULETTE,
    USES_OF_VERTEX
};
#define USE_PIXEL   0u
#define USE_VERTEX  1u
#define USE_PASSING (1u << 24)

struct path {
    const struct path_setup *setup;
    struct path_rays *rays;
    float3 *layers;
    struct sampler sampler;
    float3 origin;
    float3 direction; // unit
    float3 throughput;
    float3 from;          // the vertex that the ray left
    float density;        // of `direction`, per steradian
    bool scattered;       // there is such a vertex
    bool spread;          // and some was no mirror nor lens
    uint32_t number;      // of the sample, from 1
    uint32_t vertex;      // number of scattering events so far
    uint32_t reflections; // among them
    const struct material *media[MAX_MEDIA];
    uint32_t medium_count;
};

void path_setup_init(struct path_setup *setup, const struct reference_params *params)
{
    const struct snapshot *snapshot = params->scene;
    bool emits = lights_have_emitters(snapshot->lights);
    bool shines = environment_shines(snapshot->environment);
    bool by_light = params->estimator != REFERENCE_BSDF_SAMPLING;
    bool by_light_alone = params->estimator == REFERENCE_LIGHT_SAMPLING;
    *setup = (struct path_setup){
        .snapshot = snapshot,
        .width = params->width,
        .height = params->height,
        .max_bounces = params->max_bounces,
        .layer_count = reference_layer_count(params),
        .seed = params->seed,
        .pixel_center = params->pixel_center,
        .aims_at_emitters = by_light && emits,
        .aims_at_environment =
            by_light && shines && (by_light_alone || environment_is_uneven(snapshot->environment)),
        .finds_light = !by_light_alone,
        .rays_find = !by_light_alone && (emits || shines),
    };
    for (int axis = 0; axis < 3; axis++)
        setup->eye[axis] = (float)(params->camera.eye[axis] - snapshot->origin[axis]);
    camera_frame_init(&setup->camera, &params->camera);
}

static void get_2d(const struct path *path, enum use use, float out_u[2])
{
    sampler_get_2d(&path->sampler, USE_VERTEX + path->vertex * USES_OF_VERTEX + use, out_u);
}

static float get_1d(const struct path *path, enum use use)
{
    return sampler_get_1d(&path->sampler, USE_VERTEX + path->vertex * USES_OF_VERTEX + use);
}

static float power_heuristic(float density, float other)
{
    float ratio = other / density;
    return 1.0f / (1.0f + ratio * ratio);
}

static void log_ray(struct path_rays *rays, const struct ray *ray, bool is_shadow)
{
    uint64_t number = rays->nearest + rays->shadow;
    if (rays->log && number < rays->log_capacity)
        rays->log[number] = (struct ray_load){*ray, is_shadow};
    if (is_shadow)
        rays->shadow++;
    else
        rays->nearest++;
}

// Adds radiance that the path carries after so many reflections.
static void add_light(struct path *path, float3 radiance, uint32_t reflections,
                      bool from_environment)
{
    uint32_t layer = REFERENCE_EMISSION;
    if (reflections == 1)
        layer = from_environment ? REFERENCE_SKY : REFERENCE_DIRECT;
    else if (reflections > 1)
        layer = REFERENCE_FIRST_BOUNCE + reflections - 2;
    if (layer >= path->setup->layer_count)
        layer = path->setup->layer_count - 1;
    path->layers[layer] += path->throughput * radiance;
}

static float offset_at(float3 position, float span)
{
    float largest = max1(fabsf(position[0]), max1(fabsf(position[1]), fabsf(position[2])));
    return OFFSET_OF_PLACE * largest + OFFSET_OF_SPAN * span;
}

// The point just off a surface, on its ray's side (1) or beyond (-1).
static float3 step_off(const struct surface *surface, float side)
{
    return surface->position +
           surface->geometric_normal * (side * offset_at(surface->position, surface->span));
}

// What the body that the path is in leaves of light over a distance.
static float3 absorbed(const struct path *path, float distance)
{
    float3 left = splat3(1.0f);
    if (path->medium_count == 0)
        return left;
    float3 absorption = path->media[path->medium_count - 1]->absorption;
    if (max3(absorption) > 0.0f)
        for (int c = 0; c < 3; c++)
            left[c] = absorption[c] > 0.0f ? expf(-absorption[c] * distance) : 1.0f;
    return left;
}

static bool cast(struct path *path, struct surface *out_surface, float *out_distance)
{
    struct ray ray = {.max_distance = RAY_MAX_DISTANCE};
    store3(ray.origin, path->origin);
    store3(ray.direction, path->direction);
    log_ray(path->rays, &ray, false);
    struct ray_crossing crossing;
    if (!ray_scene_find(path->setup->snapshot->rays, &ray, &crossing) ||
        !surface_init(out_surface, path->setup->snapshot, &crossing, path->direction))
        return false;
    *out_distance = crossing.distance;
    return true;
}

// Lets the ray pass a surface, or be stopped by what covers it, by chance; the path carries the
// weight of that.
static bool passes(struct path *path, const struct surface *surface, uint32_t layer)
{
    const struct material *material = surface->material;
    if (surface->is_back && !material->refracts && path->reflections == 0)
        return true;
    if (!material->lets_through)
        return false;
    float3 passed = surface_passed(surface);
    float through = max3(passed);
    if (!(through > 0.0f))
        return false;
    // What stays is the layer's gloss and what it does not transmit.
    float stays = surface->coverage * (max3(surface->f0) + 1.0f - surface->transmission);
    float probability = through / (through + stays);
    if (surface->transmission == 0.0f)
        probability = through;
    float u = sampler_get_1d(&path->sampler, USE_PASSING + path->vertex * MAX_LAYERS + layer);
    bool goes = u < probability;
    path->throughput *=
        goes ? passed * (1.0f / probability) : splat3(surface->coverage / (1.0f - probability));
    return goes;
}

// The next surface that the path's ray does not pass through.
static bool find_surface(struct path *path, struct surface *out_surface)
{
    for (uint32_t layer = 0; layer < MAX_LAYERS; layer++) {
        float distance = RAY_MAX_DISTANCE;
        bool found = cast(path, out_surface, &distance);
        path->throughput *= absorbed(path, distance);
        if (!found)
            return false;
        if (!passes(path, out_surface, layer))
            return true;
        path->origin = step_off(out_surface, -1.0f);
    }
    return false;
}

struct shadow {
    const struct path *path;
    float3 direction;
    float3 transmittance;
};

static bool stops_light(void *context, const struct ray_crossing *crossing)
{
    struct shadow *shadow = context;
    struct surface surface;
    if (!surface_init(&surface, shadow->path->setup->snapshot, crossing, shadow->direction))
        return false;
    shadow->transmittance *= surface_passed(&surface);
    return !(max3(shadow->transmittance) > MIN_TRANSMITTANCE);
}

// What share of a light's sample reaches a surface.
static float3 transmittance_to(struct path *path, const struct surface *surface,
                               const struct light_sample *sample)
{
    if (!sample->casts_shadow)
        return splat3(1.0f);
    bool beyond = dot3(sample->direction, surface->geometric_normal) < 0.0f;
    float3 origin = step_off(surface, beyond ? -1.0f : 1.0f), along = sample->direction;
    struct ray ray = {.max_distance = RAY_MAX_DISTANCE};
    if (isfinite(sample->distance)) {
        // Aimed anew from the shifted origin, so that the ray meets nothing but at its end.
        float3 target = surface->position + sample->direction * sample->distance;
        along = target + sample->lift * offset_at(target, sample->span) - origin;
        ray.max_distance = 1.0f - 1e-5f;
        if (!(dot3(along, sample->direction) > 0.0f))
            return splat3(1.0f);
    }
    store3(ray.origin, origin);
    store3(ray.direction, along);
    log_ray(path->rays, &ray, true);
    struct shadow shadow = {path, sample->direction, splat3(1.0f)};
    if (ray_scene_is_occluded(path->setup->snapshot->rays, &ray, stops_light, &shadow))
        return splat3(0.0f);
    return beyond ? shadow.transmittance : shadow.transmittance * absorbed(path, sample->distance);
}

// Adds the light of a sample by what the surface scatters of it; aimed samples that rays find as
// well are weighted against these.
static void scatter_light(struct path *path, const struct surface *surface, const struct bsdf *bsdf,
                          const struct light_sample *sample, bool from_environment)
{
    struct scattering scattering;
    if (!bsdf_evaluate(bsdf, sample->direction, &scattering))
        return;
    float weight = 1.0f;
    if (sample->density > 0.0f) {
        weight = 1.0f / sample->density;
        if (path->setup->finds_light)
            weight *= power_heuristic(sample->density, scattering.density);
    }
    float3 light = scattering.share * sample->light * weight;
    if (!(max3(light) > 0.0f))
        return;
    light *= transmittance_to(path, surface, sample);
    bool reflected = dot3(sample->direction, surface->geometric_normal) > 0.0f;
    add_light(path, light, path->reflections + reflected, from_environment);
}

static void aim_at_lights(struct path *path, const struct surface *surface, const struct bsdf *bsdf)
{
    const struct path_setup *setup = path->setup;
    const struct snapshot *snapshot = setup->snapshot;
    struct light_sample sample;
    float u[2], choice[2];
    if (lights_have_punctual(snapshot->lights)) {
        get_2d(path, USE_LAMP, choice);
        get_2d(path, USE_LAMP_POINT, u);
        struct bsdf wide;
        const struct bsdf *lobes = bsdf;
        if (path->spread && bsdf->alpha < CAUSTIC_ALPHA) {
            wide = *bsdf;
            bsdf_widen(&wide, CAUSTIC_ALPHA * powf((float)path->number, CAUSTIC_POWER));
            lobes = &wide;
        }
        if (lights_sample_punctual(snapshot->lights, surface->position, surface->normal,
                                   bsdf->p_transmit > 0.0f, choice, u, &sample))
            scatter_light(path, surface, lobes, &sample, false);
    }
    if (setup->aims_at_emitters) {
        get_2d(path, USE_EMITTER_POINT, u);
        choice[0] = lights_are_few(snapshot->lights) ? u[0] : get_1d(path, USE_EMITTER);
        if (lights_sample_emitter(snapshot->lights, snapshot, surface->position, choice[0], u,
                                  &sample) &&
            sample.distance > 2.0f * offset_at(surface->position, surface->span))
            scatter_light(path, surface, bsdf, &sample, false);
    }
    if (setup->aims_at_environment) {
        get_2d(path, USE_ENVIRONMENT, u);
        sample = (struct light_sample){.direction = environment_sample(snapshot->environment, u),
                                       .distance = INFINITY,
                                       .casts_shadow = true};
        sample.density = environment_density(snapshot->environment, sample.direction);
        sample.light = environment_radiance(snapshot->environment, sample.direction);
        scatter_light(path, surface, bsdf, &sample, true);
    }
}

// Index of refraction on the ray's side over that beyond. Changes the path's media to those beyond
// only if `enter`.
static float cross_surface(struct path *path, const struct surface *surface, bool enter)
{
    const struct material *material = surface->material;
    if (!material->refracts)
        return 1.0f;
    uint32_t count = path->medium_count;
    if (surface->is_front) {
        float outside = count > 0 ? path->media[count - 1]->ior : 1.0f;
        if (enter && count < MAX_MEDIA)
            path->media[path->medium_count++] = material;
        return outside / material->ior;
    }
    uint32_t own = count;
    while (own > 0 && path->media[own - 1] != material)
        own--;
    uint32_t left = own > 0 ? own - 1 : count; // place of the body, if it was entered at all
    float outside = 1.0f;
    if (own > 0 && own < count)
        outside = path->media[count - 1]->ior; // still within one that begins inside this one
    else if (left > 0)
        outside = path->media[left - 1]->ior;
    if (enter && own > 0) {
        for (uint32_t i = left; i + 1 < count; i++)
            path->media[i] = path->media[i + 1];
        path->medium_count--;
    }
    return material->ior / outside;
}

// Turns the path into a random direction. False if that goes nowhere, or if the path ends by
// chance.
static bool scatter(struct path *path, const struct surface *surface, const struct bsdf *bsdf)
{
    float u[2];
    struct scattering scattering;
    get_2d(path, USE_DIRECTION, u);
    float lobe = bsdf->p_diffuse < 1.0f ? get_1d(path, USE_LOBE) : 0.0f;
    if (!bsdf_sample(bsdf, lobe, u, &path->direction, &scattering))
        return false;
    path->throughput *= scattering.share * (1.0f / scattering.density);
    path->density = scattering.density;
    path->from = surface->position;
    path->scattered = true;
    path->spread = path->spread || scattering.density < SPREAD_DENSITY;
    bool reflected = dot3(path->direction, surface->geometric_normal) > 0.0f;
    path->origin = step_off(surface, reflected ? 1.0f : -1.0f);
    if (reflected)
        path->reflections++;
    else
        cross_surface(path, surface, true);
    float largest = max3(path->throughput);
    bool survives = largest > 0.0f;
    if (survives && path->vertex >= ROULETTE_FROM_VERTEX) {
        float survival = min1(sqrtf(largest), ROULETTE_MAX_SURVIVAL);
        survives = get_1d(path, USE_ROULETTE) < survival;
        path->throughput *= 1.0f / survival;
    }
    path->vertex++;
    return survives;
}

// Adds light that the path's ray has found, weighted against what aiming at it would have given.
static void add_found(struct path *path, float3 radiance, float aimed_density,
                      bool from_environment)
{
    if (path->scattered && aimed_density > 0.0f) {
        if (!path->setup->finds_light)
            return;
        radiance *= power_heuristic(path->density, aimed_density);
    }
    add_light(path, radiance, path->reflections, from_environment);
}

static void follow(struct path *path)
{
    const struct path_setup *setup = path->setup;
    const struct snapshot *snapshot = setup->snapshot;
    struct surface surface;
    struct bsdf bsdf;
    while (path->vertex < MAX_VERTICES) {
        if (!find_surface(path, &surface)) {
            bool aimed = setup->aims_at_environment && path->scattered;
            add_found(path, environment_radiance(snapshot->environment, path->direction),
                      aimed ? environment_density(snapshot->environment, path->direction) : 0.0f,
                      true);
            return;
        }
        const struct material *material = surface.material;
        if (surface.is_back && !material->refracts)
            return;
        if (material->unlit && path->reflections > 0)
            return;
        if (max3(surface.emission) > 0.0f) {
            bool aimed = setup->aims_at_emitters && path->scattered && material->emits;
            add_found(path, surface.emission,
                      aimed ? lights_emitter_density(snapshot->lights, &surface, path->from) : 0.0f,
                      false);
        }
        // The last reflection has been: only what goes through bodies matters now.
        bool reflects = path->reflections == 0 || path->reflections - 1 < setup->max_bounces;
        if (material->unlit || !(reflects || material->refracts))
            return;
        bsdf_init(&bsdf, &surface, cross_surface(path, &surface, false),
                  reflects ? BSDF_ALL : BSDF_TRANSMISSION);
        if (bsdf.p_diffuse + bsdf.p_gloss + bsdf.p_transmit == 0.0f)
            return;
        aim_at_lights(path, &surface, &bsdf);
        bool is_last = path->reflections == setup->max_bounces;
        if (is_last && !setup->rays_find && !snapshot->has_bodies)
            return;
        if (!scatter(path, &surface, &bsdf))
            return;
    }
}

void path_add_sample(const struct path_setup *setup, struct path_rays *rays, uint32_t x, uint32_t y,
                     uint32_t sample, float3 *layers)
{
    struct path path = {
        .setup = setup,
        .rays = rays,
        .layers = layers,
        .throughput = splat3(1.0f),
        .origin = setup->eye,
        .number = sample + 1,
    };
    // Even and odd samples are sequences of their own, whose difference tells the noise.
    sampler_init(&path.sampler, setup->seed, y * setup->width + x, sample & 1u, sample >> 1);
    float at[2] = {0.5f, 0.5f}, ray[3];
    if (!setup->pixel_center)
        sampler_get_2d(&path.sampler, USE_PIXEL, at);
    camera_ray(&setup->camera, setup->width, setup->height, (float)x + at[0], (float)y + at[1],
               ray);
    path.direction = normalize3(load3(ray));
    follow(&path);
}
