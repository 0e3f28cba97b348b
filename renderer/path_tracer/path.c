#include "renderer/path_tracer/path.h"

#include <string.h>

#include "renderer/path_tracer/bsdf.h"
#include "renderer/path_tracer/environment.h"
#include "renderer/path_tracer/lights.h"
#include "renderer/path_tracer/sampler_batch.h"

#define RAY_MAX_DISTANCE 1e15f
// Offset of ray origins: some units in the last place of the surface's coordinates and of its
// triangle's extent.
#define OFFSET_OF_POSITION 2e-6f
#define OFFSET_OF_SPAN     4e-7f
// Maximum surfaces that a ray passes through, and maximum vertices of a path.
#define MAX_LAYERS   64u
#define MAX_VERTICES 4096u
// Nesting of bodies.
#define MAX_MEDIA 4u
// Russian roulette by throughput from this vertex on.
#define ROULETTE_FROM_VERTEX  3u
#define ROULETTE_MAX_SURVIVAL 0.95f
// Caustics of point lights: paths cannot find a point through a mirror or a lens. So after a
// diffuse vertex, lobes towards points are at least this wide, less with each further sample of the
// pixel: consistent (Kaplanyan and Dachsbacher 2013, "Path Space Regularization for Holistic and
// Robust Light Transport").
#define CAUSTIC_ALPHA 0.2f
#define CAUSTIC_POWER (-1.0f / 6.0f)
// Per steradian. Directions sampled with a lower density count as a diffuse vertex.
#define SPREAD_DENSITY 10.0f
// Transmittance below which a layer is opaque.
#define MIN_TRANSMITTANCE 1e-6f

// Random numbers of a vertex; see sampler.h. Pairs come first.
enum use {
    USE_LIGHT,
    USE_LIGHT_POINT,
    USE_EMITTER_POINT,
    USE_ENVIRONMENT,
    USE_DIRECTION,
    PAIRS_OF_VERTEX,
    USE_EMITTER = PAIRS_OF_VERTEX,
    USE_LOBE,
    USE_ROULETTE,
    USES_OF_VERTEX
};
#define USE_PIXEL   0u
#define USE_VERTEX  1u
#define USE_PASSING (1u << 24)

// Targets of next-event estimation: shadow rays of one kind are cast together.
enum aim { AIM_LIGHT, AIM_EMITTER, AIM_ENVIRONMENT, AIMS };

struct path {
    const struct path_setup *setup;
    struct batch *batch;
    float3 *layers;
    uint32_t slot; // among the active paths
    struct sampler sampler;
    float3 origin;
    float3 direction; // unit
    float3 throughput;
    float3 from;          // the previous vertex
    float density;        // of `direction`, per steradian
    bool scattered;       // there is a previous vertex
    bool spread;          // and some vertex was neither mirror nor lens
    uint32_t number;      // sample number, from 1
    uint32_t vertex;      // scattering events so far
    uint32_t reflections; // of these
    uint32_t passed;      // surfaces passed since the last scattering event
    const struct material *media[MAX_MEDIA];
    uint32_t medium_count;
};

// A contribution to a vertex, pending its shadow ray.
struct aimed {
    float3 *layer;
    float3 light; // added to the layer if unoccluded
    float3 direction;
    float transmittance;
};

struct aimed_batch {
    struct ray_batch rays;
    const struct path_setup *setup;
    struct aimed aimed[RAY_BATCH_SIZE];
};

// Paths that advance together, one vertex at a time.
struct batch {
    const struct path_setup *setup;
    struct path_rays *rays;
    struct path paths[PATH_BATCH_SIZE];
    struct path *active[PATH_BATCH_SIZE]; // paths that continue
    uint32_t active_count;
    struct sampler_numbers numbers[PAIRS_OF_VERTEX]; // by slot
    struct ray_batch nearest;
    struct aimed_batch aims[AIMS];
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
    bool goes_on = setup->max_bounces > 0 || setup->rays_find || snapshot->has_bodies;
    if (lights_have_punctual(snapshot->lights))
        setup->uses |= 1u << USE_LIGHT | 1u << USE_LIGHT_POINT;
    setup->uses |= (uint32_t)setup->aims_at_emitters << USE_EMITTER_POINT;
    setup->uses |= (uint32_t)setup->aims_at_environment << USE_ENVIRONMENT;
    setup->uses |= (uint32_t)goes_on << USE_DIRECTION;
    for (int axis = 0; axis < 3; axis++)
        setup->eye[axis] = (float)(params->camera.eye[axis] - snapshot->origin[axis]);
    camera_frame_init(&setup->camera, &params->camera);
}

static void get_2d(const struct path *path, enum use use, float out_u[2])
{
    const struct sampler_numbers *numbers = &path->batch->numbers[use];
    out_u[0] = numbers->u[0][path->slot];
    out_u[1] = numbers->u[1][path->slot];
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

// Layer of light after so many reflections.
static float3 *layer_of(const struct path *path, uint32_t reflections, bool from_environment)
{
    uint32_t layer = REFERENCE_EMISSION;
    if (reflections == 1)
        layer = from_environment ? REFERENCE_SKY : REFERENCE_DIRECT;
    else if (reflections > 1)
        layer = REFERENCE_FIRST_BOUNCE + reflections - 2;
    if (layer >= path->setup->layer_count)
        layer = path->setup->layer_count - 1;
    return &path->layers[layer];
}

static float offset_at(float3 position, float span)
{
    float largest = max1(fabsf(position[0]), max1(fabsf(position[1]), fabsf(position[2])));
    return OFFSET_OF_POSITION * largest + OFFSET_OF_SPAN * span;
}

// Point offset from a surface to its ray's side (1) or beyond (-1).
static float3 step_off(const struct surface *surface, float side)
{
    return surface->position +
           surface->geometric_normal * (side * offset_at(surface->position, surface->span));
}

// Transmittance over a distance of the body that the path is in.
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

// Whether the ray passes the surface or is stopped by its coverage, at random; updates throughput.
static bool passes(struct path *path, const struct surface *surface)
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
    // The layer reflects specularly, and what it does not transmit.
    float stays = surface->coverage * (max3(surface->f0) + 1.0f - surface->transmission);
    float probability = through / (through + stays);
    if (surface->transmission == 0.0f)
        probability = through;
    float u =
        sampler_get_1d(&path->sampler, USE_PASSING + path->vertex * MAX_LAYERS + path->passed);
    bool goes = u < probability;
    path->throughput *=
        goes ? passed * (1.0f / probability) : splat3(surface->coverage / (1.0f - probability));
    return goes;
}

static bool stops_light(void *context, uint32_t ray, const struct ray_crossing *crossing)
{
    struct aimed_batch *batch = context;
    struct aimed *aimed = &batch->aimed[ray];
    struct surface surface;
    if (!surface_init(&surface, batch->setup->snapshot, crossing, aimed->direction))
        return false;
    float3 passed = surface_passed(&surface);
    aimed->light *= passed;
    aimed->transmittance *= max3(passed);
    return !(aimed->transmittance > MIN_TRANSMITTANCE);
}

static void add_shadow_ray(struct path *path, const struct ray *ray, enum aim aim, float3 light,
                           float3 direction, float3 *layer)
{
    struct aimed_batch *batch = &path->batch->aims[aim];
    log_ray(path->batch->rays, ray, true);
    batch->aimed[batch->rays.count] = (struct aimed){layer, light, direction, 1.0f};
    ray_batch_add(&batch->rays, ray);
}

// Casts a shadow ray for a light sample; if unoccluded, its light is added to the layer.
static void send_light(struct path *path, const struct surface *surface,
                       const struct light_sample *sample, enum aim aim, float3 light, float3 *layer)
{
    light *= path->throughput;
    if (!sample->casts_shadow) {
        *layer += light;
        return;
    }
    bool beyond = dot3(sample->direction, surface->geometric_normal) < 0.0f;
    float3 origin = step_off(surface, beyond ? -1.0f : 1.0f), along = sample->direction;
    struct ray ray = {.max_distance = RAY_MAX_DISTANCE};
    if (isfinite(sample->distance)) {
        // Aims from the offset origin, so that the ray hits nothing before its end.
        float3 target = surface->position + sample->direction * sample->distance;
        along = target + sample->lift * offset_at(target, sample->span) - origin;
        ray.max_distance = 1.0f - 1e-5f;
        if (!(dot3(along, sample->direction) > 0.0f)) {
            *layer += light;
            return;
        }
    }
    if (!beyond)
        light *= absorbed(path, sample->distance);
    store3(ray.origin, origin);
    store3(ray.direction, along);
    add_shadow_ray(path, &ray, aim, light, sample->direction, layer);
}

// Adds a light sample times the BSDF; samples that BSDF rays can find, too, get their MIS weight.
static void scatter_light(struct path *path, const struct surface *surface, const struct bsdf *bsdf,
                          const struct light_sample *sample, enum aim aim)
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
    float3 light = scattering.fraction * sample->light * weight;
    if (!(max3(light) > 0.0f))
        return;
    bool reflected = dot3(sample->direction, surface->geometric_normal) > 0.0f;
    send_light(path, surface, sample, aim, light,
               layer_of(path, path->reflections + reflected, aim == AIM_ENVIRONMENT));
}

static void aim_at_lights(struct path *path, const struct surface *surface, const struct bsdf *bsdf)
{
    const struct path_setup *setup = path->setup;
    const struct snapshot *snapshot = setup->snapshot;
    struct light_sample sample;
    float u[2], choice[2];
    if (lights_have_punctual(snapshot->lights)) {
        get_2d(path, USE_LIGHT, choice);
        get_2d(path, USE_LIGHT_POINT, u);
        struct bsdf wide;
        const struct bsdf *lobes = bsdf;
        if (path->spread && bsdf->alpha < CAUSTIC_ALPHA) {
            wide = *bsdf;
            bsdf_widen(&wide, CAUSTIC_ALPHA * powf((float)path->number, CAUSTIC_POWER));
            lobes = &wide;
        }
        if (lights_sample_punctual(snapshot->lights, surface->position, surface->normal,
                                   bsdf->p_transmit > 0.0f, choice, u, &sample))
            scatter_light(path, surface, lobes, &sample, AIM_LIGHT);
    }
    if (setup->aims_at_emitters) {
        get_2d(path, USE_EMITTER_POINT, u);
        choice[0] = lights_are_few(snapshot->lights) ? u[0] : get_1d(path, USE_EMITTER);
        if (lights_sample_emitter(snapshot->lights, snapshot, surface->position, choice[0], u,
                                  &sample) &&
            sample.distance > 2.0f * offset_at(surface->position, surface->span))
            scatter_light(path, surface, bsdf, &sample, AIM_EMITTER);
    }
    if (setup->aims_at_environment) {
        get_2d(path, USE_ENVIRONMENT, u);
        sample = (struct light_sample){.direction = environment_sample(snapshot->environment, u),
                                       .distance = INFINITY,
                                       .casts_shadow = true};
        sample.density = environment_density(snapshot->environment, sample.direction);
        sample.light = environment_radiance(snapshot->environment, sample.direction);
        scatter_light(path, surface, bsdf, &sample, AIM_ENVIRONMENT);
    }
}

// Index of refraction on the ray's side over that beyond. Updates the path's media only if `enter`.
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
    uint32_t left = own > 0 ? own - 1 : count; // index of the body, if it was entered at all
    float outside = 1.0f;
    if (own > 0 && own < count)
        outside = path->media[count - 1]->ior; // still inside one that begins within this one
    else if (left > 0)
        outside = path->media[left - 1]->ior;
    if (enter && own > 0) {
        for (uint32_t i = left; i + 1 < count; i++)
            path->media[i] = path->media[i + 1];
        path->medium_count--;
    }
    return material->ior / outside;
}

// Samples the path's next direction. False if nothing is scattered or the path is terminated.
static bool scatter(struct path *path, const struct surface *surface, const struct bsdf *bsdf)
{
    float u[2];
    struct scattering scattering;
    get_2d(path, USE_DIRECTION, u);
    float lobe = bsdf->p_diffuse < 1.0f ? get_1d(path, USE_LOBE) : 0.0f;
    if (!bsdf_sample(bsdf, lobe, u, &path->direction, &scattering))
        return false;
    path->throughput *= scattering.fraction * (1.0f / scattering.density);
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
    path->passed = 0;
    return survives && path->vertex < MAX_VERTICES;
}

// Adds light that the path's ray has hit, MIS-weighted against next-event estimation.
static void add_found(struct path *path, float3 radiance, float aimed_density,
                      bool from_environment)
{
    if (path->scattered && aimed_density > 0.0f) {
        if (!path->setup->finds_light)
            return;
        radiance *= power_heuristic(path->density, aimed_density);
    }
    *layer_of(path, path->reflections, from_environment) += path->throughput * radiance;
}

static void find_environment(struct path *path)
{
    const struct environment *environment = path->setup->snapshot->environment;
    if (!environment_shines(environment))
        return;
    bool aimed = path->setup->aims_at_environment && path->scattered;
    add_found(path, environment_radiance(environment, path->direction),
              aimed ? environment_density(environment, path->direction) : 0.0f, true);
}

// Adds the light at the surface and samples the next direction. False if the path ends.
static bool meet(struct path *path, const struct surface *surface)
{
    const struct path_setup *setup = path->setup;
    const struct snapshot *snapshot = setup->snapshot;
    const struct material *material = surface->material;
    if (surface->is_back && !material->refracts)
        return false;
    if (material->unlit && path->reflections > 0)
        return false;
    if (max3(surface->emission) > 0.0f) {
        bool aimed = setup->aims_at_emitters && path->scattered && material->emits;
        add_found(path, surface->emission,
                  aimed ? lights_emitter_density(snapshot->lights, surface, path->from) : 0.0f,
                  false);
    }
    // After the last reflection only transmission through bodies counts.
    bool reflects = path->reflections == 0 || path->reflections - 1 < setup->max_bounces;
    if (material->unlit || !(reflects || material->refracts))
        return false;
    struct bsdf bsdf;
    bsdf_init(&bsdf, surface, cross_surface(path, surface, false),
              reflects ? BSDF_ALL : BSDF_TRANSMISSION);
    if (bsdf.p_diffuse + bsdf.p_specular + bsdf.p_transmit == 0.0f)
        return false;
    aim_at_lights(path, surface, &bsdf);
    bool is_last = path->reflections == setup->max_bounces;
    if (is_last && !setup->rays_find && !snapshot->has_bodies)
        return false;
    return scatter(path, surface, &bsdf);
}

// Advances a path to its ray's hit. False if it ends there.
static bool advance(struct path *path)
{
    const struct snapshot *snapshot = path->setup->snapshot;
    const struct ray_batch *batch = &path->batch->nearest;
    struct ray_crossing crossing;
    struct surface surface;
    bool found = ray_scene_get_crossing(snapshot->rays, batch, path->slot, &crossing) &&
                 surface_init(&surface, snapshot, &crossing, path->direction);
    if (path->medium_count > 0)
        path->throughput *= absorbed(path, found ? crossing.distance : RAY_MAX_DISTANCE);
    if (found && !passes(path, &surface))
        return meet(path, &surface);
    if (!found || ++path->passed == MAX_LAYERS) {
        find_environment(path);
        return false;
    }
    path->origin = step_off(&surface, -1.0f);
    return true;
}

static void cast_paths(struct batch *batch, bool coherent)
{
    ray_batch_init(&batch->nearest, batch->setup->snapshot->rays, coherent);
    for (uint32_t i = 0; i < batch->active_count; i++) {
        struct path *path = batch->active[i];
        path->slot = i;
        struct ray ray = {.max_distance = RAY_MAX_DISTANCE};
        store3(ray.origin, path->origin);
        store3(ray.direction, path->direction);
        log_ray(batch->rays, &ray, false);
        ray_batch_add(&batch->nearest, &ray);
    }
    ray_scene_find_all(batch->setup->snapshot->rays, &batch->nearest);
}

// Casts the shadow rays and adds all unoccluded light.
static void cast_shadows(struct batch *batch)
{
    for (uint32_t i = 0; i < AIMS; i++) {
        struct aimed_batch *aims = &batch->aims[i];
        if (aims->rays.count == 0)
            continue;
        ray_scene_occlude_all(batch->setup->snapshot->rays, &aims->rays, stops_light, aims);
        for (uint32_t ray = 0; ray < aims->rays.count; ray++)
            if (!ray_batch_is_occluded(&aims->rays, ray))
                *aims->aimed[ray].layer += aims->aimed[ray].light;
    }
}

// Starts the paths of a tile's pixels.
static void start_paths(struct batch *batch, const struct path_tile *tile, uint32_t sample,
                        float3 *layers)
{
    const struct path_setup *setup = batch->setup;
    uint32_t count = tile->width * tile->height;
    struct sampler_batch samplers = {0};
    struct sampler_numbers numbers;
    for (uint32_t i = 0; i < count; i++) {
        struct path *path = &batch->paths[i];
        uint32_t x = tile->x + i % tile->width, y = tile->y + i / tile->width;
        *path = (struct path){
            .setup = setup,
            .batch = batch,
            .layers = layers + (size_t)i * setup->layer_count,
            .throughput = splat3(1.0f),
            .origin = setup->eye,
            .number = sample + 1,
        };
        // Even and odd samples use independent sequences, whose difference estimates the noise.
        sampler_init(&path->sampler, setup->seed, y * setup->width + x, sample & 1u, sample >> 1);
        sampler_batch_set(&samplers, i, &path->sampler, USE_PIXEL);
        batch->active[i] = path;
    }
    sampler_batch_get_2d(&samplers, count, &numbers);
    for (uint32_t i = 0; i < count; i++) {
        float across = setup->pixel_center ? 0.5f : numbers.u[0][i];
        float down = setup->pixel_center ? 0.5f : numbers.u[1][i];
        float ray[3];
        camera_ray(&setup->camera, setup->width, setup->height,
                   (float)(tile->x + i % tile->width) + across,
                   (float)(tile->y + i / tile->width) + down, ray);
        batch->paths[i].direction = normalize3(load3(ray));
    }
    batch->active_count = count;
}

// Draws the random numbers of all paths for the next vertex.
static void draw_numbers(struct batch *batch)
{
    for (uint32_t use = 0; use < PAIRS_OF_VERTEX; use++) {
        if (!(batch->setup->uses & 1u << use))
            continue;
        struct sampler_batch samplers = {0};
        for (uint32_t i = 0; i < batch->active_count; i++) {
            const struct path *path = batch->active[i];
            sampler_batch_set(&samplers, i, &path->sampler,
                              USE_VERTEX + path->vertex * USES_OF_VERTEX + use);
        }
        sampler_batch_get_2d(&samplers, batch->active_count, &batch->numbers[use]);
    }
}

void path_add_samples(const struct path_setup *setup, struct path_rays *rays,
                      const struct path_tile *tile, uint32_t sample, float3 *layers)
{
    struct batch batch;
    batch.setup = setup;
    batch.rays = rays;
    for (uint32_t i = 0; i < AIMS; i++)
        batch.aims[i].setup = setup;
    start_paths(&batch, tile, sample, layers);
    // Camera rays, and their hits' shadow rays, are coherent.
    for (bool coherent = true; batch.active_count > 0; coherent = false) {
        cast_paths(&batch, coherent);
        draw_numbers(&batch);
        for (uint32_t i = 0; i < AIMS; i++)
            ray_batch_init(&batch.aims[i].rays, setup->snapshot->rays, coherent);
        uint32_t left = 0;
        for (uint32_t i = 0; i < batch.active_count; i++)
            if (advance(batch.active[i]))
                batch.active[left++] = batch.active[i];
        batch.active_count = left;
        cast_shadows(&batch);
    }
}
