#include "renderer/path_tracer/ray_bench.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#include "renderer/path_tracer/path.h"

// Rays are recorded and cast by squares of pixels, like the reference's tiles.
#define TILE_EDGE 8u
// Threads take 1 / CHUNKS of the rays at a time.
#define CHUNKS 256u

struct ray_rate {
    struct reference_params params; // with a scene of its own
    uint32_t samples;
    struct path_rays rays;
};

struct bare_loop {
    const struct ray_rate *rate;
    uint64_t count;
    uint32_t next_chunk;
    uint64_t hits;
};

static double now_seconds(clockid_t clock)
{
    struct timespec now;
    clock_gettime(clock, &now);
    return (double)now.tv_sec + (double)now.tv_nsec * 1e-9;
}

static void trace_all(const struct ray_rate *rate, struct path_rays *rays)
{
    struct path_setup setup;
    path_setup_init(&setup, &rate->params);
    uint32_t tiles_x = (setup.width + TILE_EDGE - 1) / TILE_EDGE;
    uint32_t tiles_y = (setup.height + TILE_EDGE - 1) / TILE_EDGE;
    float3 layers[TILE_EDGE * TILE_EDGE * REFERENCE_MAX_LAYERS];
    memset(layers, 0, sizeof(layers)); // the accumulated values are not used
    for (uint32_t i = 0; i < tiles_x * tiles_y; i++) {
        struct path_tile tile = {.x = i % tiles_x * TILE_EDGE, .y = i / tiles_x * TILE_EDGE};
        tile.width = setup.width - tile.x < TILE_EDGE ? setup.width - tile.x : TILE_EDGE;
        tile.height = setup.height - tile.y < TILE_EDGE ? setup.height - tile.y : TILE_EDGE;
        for (uint32_t sample = 0; sample < rate->samples; sample++)
            path_add_samples(&setup, rays, &tile, sample, layers);
    }
}

struct ray_rate *ray_rate_create(const struct reference_params *params, uint32_t samples,
                                 struct error *out_error)
{
    struct ray_rate *rate = calloc(1, sizeof(*rate));
    if (!rate) {
        error_set(out_error, "out of memory");
        return NULL;
    }
    rate->params = *params;
    rate->params.scene = snapshot_retain(params->scene);
    rate->samples = samples;
    long processors = sysconf(_SC_NPROCESSORS_ONLN);
    if (rate->params.threads == 0)
        rate->params.threads = processors > 0 ? (uint32_t)processors : 1;
    // First pass counts, second records.
    trace_all(rate, &rate->rays);
    uint64_t count = rate->rays.nearest + rate->rays.shadow;
    rate->rays = (struct path_rays){.log = malloc((count + 1) * sizeof(*rate->rays.log)),
                                    .log_capacity = count};
    if (!rate->rays.log) {
        error_set(out_error, "out of memory for %llu rays", (unsigned long long)count);
        ray_rate_destroy(&rate);
        return NULL;
    }
    trace_all(rate, &rate->rays);
    return rate;
}

void ray_rate_destroy(struct ray_rate **rate)
{
    if (*rate) {
        snapshot_release(&(*rate)->params.scene);
        free((*rate)->rays.log);
    }
    free(*rate);
    *rate = NULL;
}

static void *cast_chunks(void *context)
{
    struct bare_loop *loop = context;
    for (;;) {
        uint64_t batch = __atomic_fetch_add(&loop->next_chunk, 1, __ATOMIC_RELAXED);
        if (batch >= CHUNKS)
            return NULL;
        uint64_t from = batch * loop->count / CHUNKS, to = (batch + 1) * loop->count / CHUNKS;
        uint64_t hits = ray_scene_cast_all(loop->rate->params.scene->rays,
                                           loop->rate->rays.log + from, to - from);
        __atomic_fetch_add(&loop->hits, hits, __ATOMIC_RELAXED);
    }
}

// False if a thread cannot be created.
static bool cast_bare(const struct ray_rate *rate, struct ray_rate_result *result)
{
    struct bare_loop loop = {.rate = rate, .count = rate->rays.nearest + rate->rays.shadow};
    pthread_t threads[REFERENCE_MAX_THREADS];
    uint32_t started = 0;
    double from = now_seconds(CLOCK_MONOTONIC), cpu = now_seconds(CLOCK_PROCESS_CPUTIME_ID);
    while (started < rate->params.threads && started < REFERENCE_MAX_THREADS &&
           pthread_create(&threads[started], NULL, cast_chunks, &loop) == 0)
        started++;
    for (uint32_t i = 0; i < started; i++)
        pthread_join(threads[i], NULL);
    result->bare_seconds = now_seconds(CLOCK_MONOTONIC) - from;
    result->bare_cpu_seconds = now_seconds(CLOCK_PROCESS_CPUTIME_ID) - cpu;
    return started == rate->params.threads;
}

bool ray_rate_measure(struct ray_rate *rate, struct ray_rate_result *out_result,
                      struct error *out_error)
{
    *out_result = (struct ray_rate_result){.nearest_rays = rate->rays.nearest,
                                           .shadow_rays = rate->rays.shadow};
    struct reference *reference = reference_create(&rate->params, out_error);
    if (!reference)
        return false;
    double from = now_seconds(CLOCK_MONOTONIC), cpu = now_seconds(CLOCK_PROCESS_CPUTIME_ID);
    reference_render(reference, rate->samples);
    out_result->reference_seconds = now_seconds(CLOCK_MONOTONIC) - from;
    out_result->reference_cpu_seconds = now_seconds(CLOCK_PROCESS_CPUTIME_ID) - cpu;
    reference_destroy(&reference);
    return cast_bare(rate, out_result) || error_set(out_error, "not enough threads");
}
