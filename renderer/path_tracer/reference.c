#include "renderer/path_tracer/reference.h"

#include <assert.h>
#include <errno.h>
#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

#include "renderer/path_tracer/path.h"

#define TILE_EDGE 8u
// Maximum samples per pixel that a tile advances at a time, so that tiles stay level.
#define MAX_STEP 16u
// Leaves other processes almost all processor time, but is never starved.
#define LOWEST_PRIORITY 19
// Alpha of the images.
#define OPAQUE 1.0f

struct tile {
    uint32_t samples; // per pixel
    bool busy;        // a worker has it
};

struct reference {
    struct path_setup setup;
    struct snapshot *scene;
    bool low_priority;
    uint32_t tiles_x, tile_count;
    // Per pixel: sums of each layer (3 floats), and of the luminance of odd samples.
    uint32_t pixel_floats;
    float *sums;
    pthread_mutex_t mutex;  // protects everything below, and `sums`
    pthread_cond_t work;    // signals work to the workers
    pthread_cond_t changed; // the target is reached, or work has stopped
    struct tile *tiles;
    uint32_t target;    // wanted samples per pixel
    uint32_t level;     // samples that tiles are being advanced to
    uint32_t next_tile; // next to check
    uint32_t behind;    // tiles below `level`
    uint64_t nearest_rays, shadow_rays;
    uint32_t busy_count;
    bool quits;
    atomic_bool cancelled; // also read without the mutex
    uint32_t thread_count;
    pthread_t threads[REFERENCE_MAX_THREADS];
};

// A worker's copy of a tile.
struct work {
    uint32_t number; // of the tile
    struct path_tile tile;
    uint32_t from, to;
    struct path_rays rays;
    float3 layers[TILE_EDGE * TILE_EDGE * REFERENCE_MAX_LAYERS]; // of one sample
    float sums[TILE_EDGE * TILE_EDGE * (3 * REFERENCE_MAX_LAYERS + 1)];
};

uint32_t reference_layer_count(const struct reference_params *params)
{
    uint32_t bounces = params->bounce_pictures ? params->bounce_pictures : 1;
    return REFERENCE_FIRST_BOUNCE +
           (bounces < REFERENCE_MAX_BOUNCE_PICTURES ? bounces : REFERENCE_MAX_BOUNCE_PICTURES);
}

static uint32_t next_level(uint32_t level, uint32_t target)
{
    uint32_t step = level < MAX_STEP ? (level ? level : 1) : MAX_STEP;
    return target - level > step ? level + step : target;
}

// Advances to the next level that some tile has not reached; call with the mutex held.
static void advance_level(struct reference *reference)
{
    reference->next_tile = 0;
    reference->behind = 0;
    while (reference->behind == 0 && reference->level < reference->target) {
        reference->level = next_level(reference->level, reference->target);
        for (uint32_t i = 0; i < reference->tile_count; i++)
            reference->behind += reference->tiles[i].samples < reference->level;
    }
}

static float *pixel_sums(const struct reference *reference, uint32_t x, uint32_t y)
{
    size_t pixel = (size_t)y * reference->setup.width + x;
    return reference->sums + pixel * reference->pixel_floats;
}

// Copies a tile's rows from the image, or back; call with the mutex held.
static void copy_sums(const struct reference *reference, struct work *work, bool back)
{
    size_t row_floats = (size_t)work->tile.width * reference->pixel_floats;
    for (uint32_t row = 0; row < work->tile.height; row++) {
        float *picture = pixel_sums(reference, work->tile.x, work->tile.y + row);
        float *own = work->sums + row * row_floats;
        memcpy(back ? picture : own, back ? own : picture, row_floats * sizeof(float));
    }
}

static uint32_t smaller(uint32_t a, uint32_t b)
{
    return a < b ? a : b;
}

// Takes the next tile that is below the level and not busy; call with the mutex held. False if
// there is none now.
static bool take_tile(struct reference *reference, struct work *work)
{
    if (atomic_load(&reference->cancelled))
        return false;
    while (reference->next_tile < reference->tile_count) {
        uint32_t number = reference->next_tile++;
        struct tile *tile = &reference->tiles[number];
        if (tile->busy || tile->samples >= reference->level)
            continue;
        tile->busy = true;
        reference->busy_count++;
        const struct path_setup *setup = &reference->setup;
        work->number = number;
        work->tile.x = number % reference->tiles_x * TILE_EDGE;
        work->tile.y = number / reference->tiles_x * TILE_EDGE;
        work->tile.width = smaller(setup->width - work->tile.x, TILE_EDGE);
        work->tile.height = smaller(setup->height - work->tile.y, TILE_EDGE);
        work->from = tile->samples;
        work->to = reference->level;
        work->rays = (struct path_rays){0};
        copy_sums(reference, work, false);
        return true;
    }
    return false;
}

// Adds the layers of one sample of a pixel to its sums.
static void add_layers(const struct reference *reference, const float3 *layers, uint32_t sample,
                       float *sums)
{
    uint32_t layer_count = reference->setup.layer_count;
    float3 total = splat3(0.0f);
    for (uint32_t layer = 0; layer < layer_count; layer++)
        total += layers[layer];
    // Drops samples that overflowed, rather than spoil the image.
    if (!isfinite(total[0]) || !isfinite(total[1]) || !isfinite(total[2]))
        return;
    for (uint32_t layer = 0; layer < layer_count; layer++)
        for (uint32_t c = 0; c < 3; c++)
            sums[3 * layer + c] += layers[layer][c];
    if (sample & 1u)
        sums[reference->pixel_floats - 1] += luminance3(total);
}

// False if cancelled.
static bool trace_tile(struct reference *reference, struct work *work)
{
    uint32_t pixels = work->tile.width * work->tile.height;
    uint32_t layer_count = reference->setup.layer_count;
    for (uint32_t sample = work->from; sample < work->to; sample++) {
        memset(work->layers, 0, (size_t)pixels * layer_count * sizeof(work->layers[0]));
        path_add_samples(&reference->setup, &work->rays, &work->tile, sample, work->layers);
        for (uint32_t i = 0; i < pixels; i++)
            add_layers(reference, work->layers + (size_t)i * layer_count, sample,
                       work->sums + (size_t)i * reference->pixel_floats);
        if (atomic_load_explicit(&reference->cancelled, memory_order_relaxed))
            return false;
    }
    return true;
}

// Call with the mutex held.
static void give_tile_back(struct reference *reference, struct work *work, bool done)
{
    struct tile *tile = &reference->tiles[work->number];
    tile->busy = false;
    reference->busy_count--;
    bool was_behind = tile->samples < reference->level;
    if (done) {
        copy_sums(reference, work, true);
        tile->samples = work->to;
        reference->nearest_rays += work->rays.nearest;
        reference->shadow_rays += work->rays.shadow;
    }
    if (tile->samples < reference->level) {
        // Cancelled, or taken for a lower level: have it checked again.
        if (work->number < reference->next_tile)
            reference->next_tile = work->number;
        pthread_cond_broadcast(&reference->work);
    } else if (was_behind && --reference->behind == 0) {
        advance_level(reference);
        pthread_cond_broadcast(reference->behind > 0 ? &reference->work : &reference->changed);
    }
    if (reference->busy_count == 0 && atomic_load(&reference->cancelled))
        pthread_cond_broadcast(&reference->changed);
}

static void *worker(void *context)
{
    struct reference *reference = context;
    if (reference->low_priority)
        setpriority(PRIO_PROCESS, (id_t)gettid(), LOWEST_PRIORITY);
    struct work *work = malloc(sizeof(*work));
    pthread_mutex_lock(&reference->mutex);
    while (!reference->quits && work) {
        if (!take_tile(reference, work)) {
            pthread_cond_wait(&reference->work, &reference->mutex);
            continue;
        }
        pthread_mutex_unlock(&reference->mutex);
        bool done = trace_tile(reference, work);
        pthread_mutex_lock(&reference->mutex);
        give_tile_back(reference, work, done);
    }
    pthread_mutex_unlock(&reference->mutex);
    free(work);
    return NULL;
}

// Workers block signals: these belong to the threads that handle them.
static bool start_workers(struct reference *reference, uint32_t wanted)
{
    sigset_t all, before;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    while (reference->thread_count < wanted &&
           pthread_create(&reference->threads[reference->thread_count], NULL, worker, reference) ==
               0)
        reference->thread_count++;
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    return reference->thread_count > 0;
}

static void init_locks(struct reference *reference)
{
    pthread_condattr_t attributes;
    pthread_condattr_init(&attributes);
    pthread_condattr_setclock(&attributes, CLOCK_MONOTONIC);
    pthread_mutex_init(&reference->mutex, NULL);
    pthread_cond_init(&reference->changed, &attributes);
    pthread_cond_init(&reference->work, NULL);
    pthread_condattr_destroy(&attributes);
}

struct reference *reference_create(const struct reference_params *params, struct error *out_error)
{
    assert(params->width > 0 && params->height > 0);
    struct reference *reference = aligned_alloc(16, (sizeof(*reference) + 15) & ~(size_t)15);
    if (!reference)
        goto fail;
    *reference = (struct reference){.scene = snapshot_retain(params->scene),
                                    .low_priority = params->low_priority,
                                    .tiles_x = (params->width + TILE_EDGE - 1) / TILE_EDGE};
    init_locks(reference);
    path_setup_init(&reference->setup, params);
    reference->tile_count = reference->tiles_x * ((params->height + TILE_EDGE - 1) / TILE_EDGE);
    reference->pixel_floats = 3 * reference->setup.layer_count + 1;
    size_t pixels = (size_t)params->width * params->height;
    reference->sums = calloc(pixels, reference->pixel_floats * sizeof(float));
    reference->tiles = calloc(reference->tile_count, sizeof(*reference->tiles));
    long processors = sysconf(_SC_NPROCESSORS_ONLN);
    uint32_t wanted = params->threads ? params->threads : processors > 0 ? (uint32_t)processors : 1;
    wanted = wanted < REFERENCE_MAX_THREADS ? wanted : REFERENCE_MAX_THREADS;
    if (reference->sums && reference->tiles && start_workers(reference, wanted))
        return reference;
fail:
    error_set(out_error, "a reference of %u x %u pixels does not fit into memory", params->width,
              params->height);
    if (reference)
        reference_destroy(&reference);
    return NULL;
}

void reference_destroy(struct reference **reference_slot)
{
    struct reference *reference = *reference_slot;
    *reference_slot = NULL;
    if (!reference)
        return;
    atomic_store(&reference->cancelled, true);
    pthread_mutex_lock(&reference->mutex);
    reference->quits = true;
    pthread_cond_broadcast(&reference->work);
    pthread_mutex_unlock(&reference->mutex);
    for (uint32_t i = 0; i < reference->thread_count; i++)
        pthread_join(reference->threads[i], NULL);
    pthread_mutex_destroy(&reference->mutex);
    pthread_cond_destroy(&reference->changed);
    pthread_cond_destroy(&reference->work);
    snapshot_release(&reference->scene);
    free(reference->sums);
    free(reference->tiles);
    free(reference);
}

// Minimum samples over all pixels; call with the mutex held.
static uint32_t min_samples(const struct reference *reference)
{
    uint32_t minimum = UINT32_MAX;
    for (uint32_t i = 0; i < reference->tile_count; i++)
        if (reference->tiles[i].samples < minimum)
            minimum = reference->tiles[i].samples;
    return minimum;
}

void reference_start(struct reference *reference, uint32_t samples)
{
    pthread_mutex_lock(&reference->mutex);
    atomic_store(&reference->cancelled, false);
    reference->target = samples < REFERENCE_MAX_SAMPLES ? samples : REFERENCE_MAX_SAMPLES;
    uint32_t minimum = min_samples(reference);
    reference->level = minimum < reference->target ? minimum : reference->target;
    advance_level(reference);
    pthread_cond_broadcast(&reference->work);
    pthread_mutex_unlock(&reference->mutex);
}

bool reference_wait(struct reference *reference, double seconds)
{
    struct timespec end;
    clock_gettime(CLOCK_MONOTONIC, &end);
    double limit = fmin(fmax(seconds, 0.0), 1e9);
    end.tv_sec += (time_t)limit;
    end.tv_nsec += (long)((limit - floor(limit)) * 1e9);
    end.tv_sec += end.tv_nsec / 1000000000;
    end.tv_nsec %= 1000000000;
    pthread_mutex_lock(&reference->mutex);
    int status = 0;
    while (status != ETIMEDOUT && !atomic_load(&reference->cancelled) &&
           min_samples(reference) < reference->target)
        status = pthread_cond_timedwait(&reference->changed, &reference->mutex, &end);
    bool reached = min_samples(reference) >= reference->target;
    pthread_mutex_unlock(&reference->mutex);
    return reached;
}

void reference_stop(struct reference *reference)
{
    atomic_store(&reference->cancelled, true);
    pthread_mutex_lock(&reference->mutex);
    pthread_cond_broadcast(&reference->changed);
    while (reference->busy_count > 0)
        pthread_cond_wait(&reference->changed, &reference->mutex);
    pthread_mutex_unlock(&reference->mutex);
}

bool reference_render(struct reference *reference, uint32_t samples)
{
    pthread_mutex_lock(&reference->mutex);
    uint32_t wanted = min_samples(reference) + samples;
    pthread_mutex_unlock(&reference->mutex);
    reference_start(reference, wanted);
    return reference_wait(reference, INFINITY);
}

uint32_t reference_get_samples(struct reference *reference)
{
    pthread_mutex_lock(&reference->mutex);
    uint32_t samples = min_samples(reference);
    pthread_mutex_unlock(&reference->mutex);
    return samples;
}

void reference_get_progress(struct reference *reference, struct reference_progress *out_progress)
{
    const struct path_setup *setup = &reference->setup;
    double sum = 0.0, squared_error = 0.0;
    bool estimated = true;
    pthread_mutex_lock(&reference->mutex);
    for (uint32_t y = 0; y < setup->height; y++)
        for (uint32_t x = 0; x < setup->width; x++) {
            uint32_t samples =
                reference->tiles[y / TILE_EDGE * reference->tiles_x + x / TILE_EDGE].samples;
            const float *sums = pixel_sums(reference, x, y);
            double luminance = 0.0, odd = sums[reference->pixel_floats - 1];
            for (uint32_t layer = 0; layer < setup->layer_count; layer++)
                luminance += (double)luminance3(load3(sums + (size_t)3 * layer));
            estimated = estimated && samples >= 2;
            if (samples < 2)
                continue;
            // Variance of a mean of two halves, from their difference.
            double odd_count = samples / 2, even_count = samples - odd_count;
            double difference = odd / odd_count - (luminance - odd) / even_count;
            squared_error +=
                difference * difference * odd_count * even_count / ((double)samples * samples);
            sum += luminance / samples;
        }
    double pixels = (double)setup->width * setup->height;
    *out_progress = (struct reference_progress){.samples = min_samples(reference),
                                                .nearest_rays = reference->nearest_rays,
                                                .shadow_rays = reference->shadow_rays,
                                                .mean_luminance = sum / pixels};
    out_progress->noise = INFINITY;
    if (estimated)
        out_progress->noise = sum > 0.0 ? sqrt(squared_error / pixels) / (sum / pixels) : 0.0;
    pthread_mutex_unlock(&reference->mutex);
}

void reference_get_picture(struct reference *reference, uint32_t layers, float *out_rgba)
{
    const struct path_setup *setup = &reference->setup;
    for (uint32_t y = 0; y < setup->height; y++) {
        pthread_mutex_lock(&reference->mutex); // row by row, so that workers wait only briefly
        for (uint32_t x = 0; x < setup->width; x++) {
            uint32_t samples =
                reference->tiles[y / TILE_EDGE * reference->tiles_x + x / TILE_EDGE].samples;
            const float *sums = pixel_sums(reference, x, y);
            float3 sum = splat3(0.0f);
            for (uint32_t layer = 0; layer < setup->layer_count; layer++)
                if (layers & REFERENCE_LAYER(layer))
                    sum += load3(sums + (size_t)3 * layer);
            float *pixel = out_rgba + ((size_t)y * setup->width + x) * 4;
            store3(pixel, sum * (samples ? 1.0f / (float)samples : 0.0f));
            pixel[3] = OPAQUE;
        }
        pthread_mutex_unlock(&reference->mutex);
    }
}
