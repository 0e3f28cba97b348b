#include "renderer/reference/path_tracer.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include "renderer/camera.h"
#include "renderer/scene/vector3.h"
#include "renderer/reference/path_brdf.h"
#include "renderer/reference/path_lights.h"
#include "renderer/reference/path_surface.h"

#define MAX_THREADS      16u
#define RAY_MAX_DISTANCE 1e15
// Rays start this far off a surface, in diagonals of the scene.
#define RAY_OFFSET 1e-5
// Surfaces that one ray may pass through.
#define MAX_LAYERS 64
// Paths end by chance from here on (Russian roulette), by how much light they still carry.
#define ROULETTE_FROM_REFLECTION 4u
#define ROULETTE_MAX_SURVIVAL    0.95

struct tracer {
    const struct path_params *params;
    struct path_picture *picture;
    struct ray_scene *rays;
    struct path_lights *lights;
    struct camera_frame camera;
    double offset_m;
    atomic_uint next_row;
};

struct path {
    const struct tracer *tracer;
    uint64_t random;
    double origin[3];
    double direction[3]; // unit
    double throughput[3];
    double density;       // of `direction`, per steradian; unused before the first reflection
    double from[3];       // the vertex that the ray left
    uint32_t reflections; // so far
    double direct[3], sky[3], indirect[3];
};

// SplitMix64 (Steele, Lea and Flood 2014, "Fast Splittable Pseudorandom Number Generators").
static uint64_t next_bits(uint64_t *state)
{
    uint64_t z = (*state += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

static double next_random(struct path *path)
{
    return (double)(next_bits(&path->random) >> 11) * 0x1p-53;
}

// Adds radiance that the path carries after so many reflections.
static void add_light(struct path *path, const double radiance[3], double weight,
                      uint32_t reflections, bool from_environment)
{
    double *target = path->direct;
    if (reflections >= 2)
        target = path->indirect;
    else if (reflections == 1 && from_environment)
        target = path->sky;
    for (int c = 0; c < 3; c++)
        target[c] += path->throughput[c] * radiance[c] * weight;
}

static bool cast(const struct tracer *tracer, const double origin[3], const double direction[3],
                 double max_distance, struct path_surface *out_surface)
{
    const float from[3] = {(float)origin[0], (float)origin[1], (float)origin[2]};
    const float along[3] = {(float)direction[0], (float)direction[1], (float)direction[2]};
    struct ray_hit hit;
    float reach = (float)fmin(max_distance, RAY_MAX_DISTANCE);
    return ray_scene_intersect(tracer->rays, from, along, reach, &hit) &&
           path_surface_init(out_surface, tracer->params->scene, &hit, direction);
}

// The point just off a surface, on its ray's side or beyond.
static void step_off(const struct tracer *tracer, const struct path_surface *surface, double side,
                     double out_origin[3])
{
    for (int axis = 0; axis < 3; axis++)
        out_origin[axis] =
            surface->position[axis] + side * tracer->offset_m * surface->geometric_normal[axis];
}

// The next surface that the path's ray does not pass through.
static bool find_surface(struct path *path, struct path_surface *out_surface)
{
    for (int i = 0; i < MAX_LAYERS; i++) {
        if (!cast(path->tracer, path->origin, path->direction, INFINITY, out_surface))
            return false;
        bool culled = out_surface->is_back && path->reflections == 0;
        bool passes = out_surface->passed > 0.0 && next_random(path) < out_surface->passed;
        if (!culled && !passes)
            return true;
        for (int c = 0; c < 3 && !culled; c++)
            path->throughput[c] *= out_surface->passed_tint[c];
        step_off(path->tracer, out_surface, -1.0, path->origin);
    }
    return false;
}

// Whether something opaque stands between a surface and a point; or, for NULL, anywhere in the
// direction.
static bool is_shadowed(const struct tracer *tracer, const struct path_surface *surface,
                        const double *target, const double direction[3])
{
    struct path_surface blocker;
    double origin[3], along[3], left = INFINITY;
    memcpy(along, direction, sizeof(along));
    step_off(tracer, surface, 1.0, origin);
    for (int i = 0; i < MAX_LAYERS; i++) {
        if (target) {
            // Aimed anew from the shifted origin, so that the ray meets nothing but at its end.
            vector3_subtract(along, target, origin);
            left = vector3_length(along);
            if (!(left > 0.0) || vector3_dot(along, direction) <= 0.0)
                return false;
            for (int axis = 0; axis < 3; axis++)
                along[axis] /= left;
            left *= 1.0 - 1e-6;
        }
        if (!cast(tracer, origin, along, left, &blocker))
            return false;
        if (blocker.passed == 0.0)
            return true;
        step_off(tracer, &blocker, -1.0, origin);
    }
    return true;
}

static void reflect_light(struct path *path, const struct path_reflection *reflection,
                          const double light[3], double weight)
{
    double reflected[3];
    for (int c = 0; c < 3; c++)
        reflected[c] = reflection->share[c] * light[c];
    add_light(path, reflected, weight, path->reflections + 1, false);
}

static void sample_punctual(struct path *path, const struct path_surface *surface)
{
    const struct tracer *tracer = path->tracer;
    struct path_light_sample sample;
    if (!path_lights_choose_punctual(tracer->lights, surface->position, surface->normal,
                                     next_random(path), &sample))
        return;
    struct path_reflection reflection;
    double position[3];
    for (int axis = 0; axis < 3; axis++)
        position[axis] = surface->position[axis] + sample.direction[axis] * sample.distance;
    const double *target = isfinite(sample.distance) ? position : NULL;
    if (path_brdf_evaluate(surface, sample.direction, &reflection) &&
        !(sample.casts_shadow && is_shadowed(tracer, surface, target, sample.direction)))
        reflect_light(path, &reflection, sample.light, 1.0);
}

// Density per steradian of choosing, by area, the direction from `from` to a point of an emitter.
static double emitter_density(const struct tracer *tracer, const struct path_surface *emitter,
                              const double from[3])
{
    double to_emitter[3];
    vector3_subtract(to_emitter, emitter->position, from);
    double distance = vector3_length(to_emitter);
    double cosine = -vector3_dot(emitter->geometric_normal, to_emitter) / distance;
    double per_area = path_lights_emitter_density(tracer->lights, emitter->material);
    return cosine > 1e-9 ? per_area * distance * distance / cosine : INFINITY;
}

static void sample_emitter(struct path *path, const struct path_surface *surface)
{
    const struct tracer *tracer = path->tracer;
    const double u[3] = {next_random(path), next_random(path), next_random(path)};
    struct ray_hit point;
    struct path_surface emitter;
    double corners[3][3], normal[3], direction[3];
    if (!path_lights_choose_emitter(tracer->lights, u, &point))
        return;
    path_triangle_corners(tracer->params->scene, &point, corners, normal);
    const double weights[3] = {1.0 - point.barycentric[0] - point.barycentric[1],
                               point.barycentric[0], point.barycentric[1]};
    for (int axis = 0; axis < 3; axis++) {
        direction[axis] = -surface->position[axis];
        for (int corner = 0; corner < 3; corner++)
            direction[axis] += weights[corner] * corners[corner][axis];
    }
    double distance = vector3_length(direction);
    if (!(distance > 2.0 * tracer->offset_m))
        return;
    for (int axis = 0; axis < 3; axis++)
        direction[axis] /= distance;
    if (!path_surface_init(&emitter, tracer->params->scene, &point, direction) || emitter.is_back)
        return;
    struct path_reflection reflection;
    double density = emitter_density(tracer, &emitter, surface->position), target[3];
    step_off(tracer, &emitter, 1.0, target);
    // The balance heuristic: this density against that of the path's next ray.
    if (isfinite(density) && path_brdf_evaluate(surface, direction, &reflection) &&
        !is_shadowed(tracer, surface, target, direction))
        reflect_light(path, &reflection, emitter.emission,
                      (1.0 - emitter.passed) / (density + reflection.density));
}

// Turns the path into a random direction. False if that points into the surface, or if the path
// ends by chance.
static bool reflect(struct path *path, const struct path_surface *surface)
{
    const double u[3] = {next_random(path), next_random(path), next_random(path)};
    struct path_reflection reflection;
    if (!path_brdf_sample(surface, u, path->direction, &reflection))
        return false;
    path->density = reflection.density;
    double largest = 0.0;
    for (int c = 0; c < 3; c++) {
        path->throughput[c] *= reflection.share[c] / reflection.density;
        largest = fmax(largest, path->throughput[c]);
    }
    path->reflections++;
    memcpy(path->from, surface->position, sizeof(path->from));
    step_off(path->tracer, surface, 1.0, path->origin);
    if (path->reflections < ROULETTE_FROM_REFLECTION)
        return largest > 0.0;
    double survival = fmin(sqrt(largest), ROULETTE_MAX_SURVIVAL);
    if (next_random(path) >= survival)
        return false;
    for (int c = 0; c < 3; c++)
        path->throughput[c] /= survival;
    return true;
}

static void follow(struct path *path)
{
    const struct tracer *tracer = path->tracer;
    const struct path_params *params = tracer->params;
    struct path_surface surface;
    for (;;) {
        if (!find_surface(path, &surface)) {
            double radiance[3];
            path_environment(params->scene, path->direction, radiance);
            add_light(path, radiance, 1.0, path->reflections, true);
            return;
        }
        if (surface.is_back || (surface.unlit && path->reflections > 0))
            return;
        double weight = 1.0;
        if (path->reflections > 0)
            weight =
                path->density / (path->density + emitter_density(tracer, &surface, path->from));
        add_light(path, surface.emission, weight, path->reflections, false);
        if (surface.unlit || (path->reflections > 0 && path->reflections - 1 >= params->bounces))
            return;
        sample_punctual(path, &surface);
        sample_emitter(path, &surface);
        if (!reflect(path, &surface))
            return;
    }
}

static void trace_pixel(const struct tracer *tracer, uint32_t x, uint32_t y)
{
    const struct path_params *params = tracer->params;
    double direct[3] = {0}, sky[3] = {0}, indirect[3] = {0};
    for (uint32_t i = 0; i < params->samples; i++) {
        struct path path = {.tracer = tracer, .throughput = {1.0, 1.0, 1.0}};
        uint64_t pixel = (uint64_t)y * params->width + x;
        path.random = params->seed ^ (pixel * params->samples + i) * 0xd1342543de82ef95u;
        path.random = next_bits(&path.random); // neighbours start far apart
        double across = params->pixel_center ? 0.5 : next_random(&path);
        double down = params->pixel_center ? 0.5 : next_random(&path);
        float ray[3];
        camera_ray(&tracer->camera, params->width, params->height, (float)(x + across),
                   (float)(y + down), ray);
        double length =
            sqrt((double)ray[0] * ray[0] + (double)ray[1] * ray[1] + (double)ray[2] * ray[2]);
        for (int axis = 0; axis < 3; axis++) {
            path.origin[axis] = params->camera.eye[axis];
            path.direction[axis] = ray[axis] / length;
        }
        follow(&path);
        for (int c = 0; c < 3; c++) {
            direct[c] += path.direct[c];
            sky[c] += path.sky[c];
            indirect[c] += path.indirect[c];
        }
    }
    size_t first = ((size_t)y * params->width + x) * 4;
    for (size_t c = 0; c < 4; c++) {
        tracer->picture->direct[first + c] = c < 3 ? (float)(direct[c] / params->samples) : 1.0f;
        tracer->picture->sky[first + c] = c < 3 ? (float)(sky[c] / params->samples) : 1.0f;
        tracer->picture->indirect[first + c] =
            c < 3 ? (float)(indirect[c] / params->samples) : 1.0f;
    }
}

static void *trace_rows(void *context)
{
    struct tracer *tracer = context;
    for (;;) {
        uint32_t y = atomic_fetch_add(&tracer->next_row, 1);
        if (y >= tracer->params->height)
            return NULL;
        for (uint32_t x = 0; x < tracer->params->width; x++)
            trace_pixel(tracer, x, y);
    }
}

static void run_threads(struct tracer *tracer)
{
    pthread_t threads[MAX_THREADS];
    uint32_t wanted = tracer->params->threads ? tracer->params->threads : 2, started = 0;
    while (started + 1 < wanted && started < MAX_THREADS &&
           pthread_create(&threads[started], NULL, trace_rows, tracer) == 0)
        started++;
    trace_rows(tracer);
    for (uint32_t i = 0; i < started; i++)
        pthread_join(threads[i], NULL);
}

bool path_trace(const struct path_params *params, struct path_picture *out_picture)
{
    size_t bytes = (size_t)params->width * params->height * 4 * sizeof(float);
    struct path_picture picture = {params->width, params->height, malloc(bytes), malloc(bytes),
                                   malloc(bytes)};
    struct tracer tracer = {.params = params,
                            .picture = &picture,
                            .rays = ray_scene_create(params->scene),
                            .lights = path_lights_create(params->scene)};
    bool done = picture.direct && picture.sky && picture.indirect && tracer.rays && tracer.lights;
    if (done) {
        double low[3] = {0}, high[3] = {0}, size[3];
        scene_bounds(params->scene, low, high);
        vector3_subtract(size, high, low);
        tracer.offset_m = RAY_OFFSET * fmax(vector3_length(size), 1e-6);
        camera_frame_init(&tracer.camera, &params->camera);
        run_threads(&tracer);
        *out_picture = picture;
    } else {
        path_picture_finish(&picture);
    }
    ray_scene_destroy(&tracer.rays);
    path_lights_destroy(&tracer.lights);
    return done;
}

void path_picture_finish(struct path_picture *picture)
{
    free(picture->direct);
    free(picture->sky);
    free(picture->indirect);
    *picture = (struct path_picture){0};
}
