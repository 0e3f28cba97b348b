#include "renderer/path_tracer/progressive.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

#include "renderer/clock.h"

// Camera and scene must be unchanged for so long.
#define REST_MS 150.0
// Fetches a new image when it has this factor more samples, at most every INTERVAL_MS: drawing and
// encoding take time from tracing.
#define SAMPLES_STEP 1.2
#define INTERVAL_MS  100.0
// Of the builder and of the reference's workers.
#define LOWEST_PRIORITY 19
// Target, and limit.
#define WANTED_NOISE   0.01
#define WANTED_SAMPLES 16384u

static void *build(void *context)
{
    struct live_scene *scene = context;
    struct error ignored;
    setpriority(PRIO_PROCESS, (id_t)gettid(), LOWEST_PRIORITY);
    bool done = snapshot_build(scene->snapshot, true, &ignored);
    __atomic_store_n(&scene->built, done ? 1 : -1, __ATOMIC_RELEASE);
    return NULL;
}

void live_scene_finish(struct live_scene *scene)
{
    if (scene->builds)
        pthread_join(scene->builder, NULL);
    if (scene->snapshot)
        snapshot_release(&scene->snapshot);
    *scene = (struct live_scene){0};
}

bool live_scene_is_building(const struct live_scene *scene)
{
    return scene->builds && __atomic_load_n(&scene->built, __ATOMIC_ACQUIRE) == 0;
}

bool live_reference_is_used(const struct live_reference *live)
{
    return live->params.scene != NULL;
}

void live_reference_finish(struct live_reference *live)
{
    if (live->reference)
        reference_destroy(&live->reference);
    free(live->rgba);
    *live = (struct live_reference){0};
}

static bool same_revisions(const struct scene_revisions *a, const struct scene_revisions *b)
{
    return memcmp(a, b, sizeof(*a)) == 0;
}

static bool same_params(const struct live_reference *live, const struct live_params *params)
{
    const struct live_params *last = &live->params;
    return last->scene_number == params->scene_number &&
           memcmp(&last->camera, &params->camera, sizeof(last->camera)) == 0 &&
           last->width == params->width && last->height == params->height &&
           last->max_bounces == params->max_bounces &&
           last->all_blinn_phong == params->all_blinn_phong &&
           last->direct_only == params->direct_only &&
           same_revisions(&live->revisions, &params->scene->revisions);
}

// Whether there is a snapshot of the present scene. If not, starts a build once the last builder is
// done.
static bool has_snapshot(struct live_scene *scene, const struct live_params *params,
                         struct error *out_error)
{
    if (scene->builds) {
        if (live_scene_is_building(scene))
            return false;
        pthread_join(scene->builder, NULL);
        scene->builds = false;
        if (scene->built < 0) {
            live_scene_finish(scene);
            return error_set(out_error, "out of memory for tracing the scene");
        }
    }
    if (scene->snapshot && scene->scene_number == params->scene_number &&
        scene->all_blinn_phong == params->all_blinn_phong &&
        same_revisions(&scene->revisions, &params->scene->revisions))
        return true;
    live_scene_finish(scene);
    scene->snapshot = snapshot_copy(params->scene, params->all_blinn_phong, out_error);
    if (!scene->snapshot)
        return false;
    scene->scene_number = params->scene_number;
    scene->revisions = params->scene->revisions;
    scene->all_blinn_phong = params->all_blinn_phong;
    scene->builds = pthread_create(&scene->builder, NULL, build, scene) == 0;
    if (!scene->builds) {
        live_scene_finish(scene);
        return error_set(out_error, "no thread for building a snapshot");
    }
    return false;
}

// Also false while there is no snapshot.
static bool start(struct live_reference *live, struct live_scene *scene, struct error *out_error)
{
    const struct live_params *params = &live->params;
    if (!has_snapshot(scene, params, out_error))
        return false;
    live->reference = reference_create(
        &(struct reference_params){.scene = scene->snapshot,
                                   .camera = params->camera,
                                   .width = params->width,
                                   .height = params->height,
                                   .max_bounces = params->direct_only ? 0 : params->max_bounces,
                                   .low_priority = true},
        out_error);
    if (!live->reference)
        return false;
    live->rgba = malloc((size_t)params->width * params->height * 4 * sizeof(float));
    if (!live->rgba) {
        reference_destroy(&live->reference);
        return error_set(out_error, "out of memory for an image of %u x %u", params->width,
                         params->height);
    }
    reference_start(live->reference, WANTED_SAMPLES);
    return true;
}

enum live_state live_reference_update(struct live_reference *live, struct live_scene *scene,
                                      const struct live_params *params, struct error *out_error)
{
    double now = clock_now_ms();
    if (!same_params(live, params)) {
        live_reference_finish(live);
        live->params = *params;
        live->revisions = params->scene->revisions;
        live->changed_at_ms = now;
    }
    if (live->converged)
        return LIVE_FINISHED;
    if (!live->reference) {
        bool rests = now - live->changed_at_ms >= REST_MS;
        if (rests && !start(live, scene, out_error) && out_error->message[0])
            live->changed_at_ms = now; // tries again later
        return LIVE_WAITING;
    }
    uint32_t samples = reference_get_samples(live->reference);
    enum live_state not_yet = live->shown_samples > 0 ? LIVE_SAME : LIVE_WAITING;
    if (samples < live->shown_samples * SAMPLES_STEP + 1.0 && samples < WANTED_SAMPLES)
        return not_yet;
    if (samples == 0 || (live->shown_samples > 0 && now - live->shown_at_ms < INTERVAL_MS))
        return not_yet;
    reference_get_progress(live->reference, &live->progress);
    reference_get_picture(live->reference, REFERENCE_ALL_LAYERS, live->rgba);
    live->shown_samples = samples;
    live->shown_at_ms = now;
    live->converged = live->progress.noise < WANTED_NOISE || samples >= WANTED_SAMPLES;
    if (live->converged)
        reference_stop(live->reference);
    return LIVE_NEW;
}

float live_reference_convergence(const struct live_reference *live)
{
    if (live->converged)
        return 1.0f;
    if (live->shown_samples == 0 || !(live->progress.noise > 0.0))
        return 0.0f;
    // Noise falls with the square root of the samples.
    double ratio = WANTED_NOISE / live->progress.noise;
    double fraction = fmax(ratio * ratio, (double)live->shown_samples / WANTED_SAMPLES);
    return (float)fmin(fraction, 0.99);
}
