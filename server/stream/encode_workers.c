#include "server/stream/encode_workers.h"

#include <pthread.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "renderer/clock.h"
#include "server/stream/frame_encoder.h"

// Credits bound the jobs: FRAME_STREAM_MAX_UNACKNOWLEDGED for each client.
#define MAX_JOBS (FRAME_STREAM_MAX_CLIENTS * FRAME_STREAM_MAX_UNACKNOWLEDGED)

struct job {
    uint32_t slot;
    struct frame_header header;
    struct frame_planes image; // in bytes
    uint8_t bytes[];
};

struct encode_workers {
    struct encode_workers_params params;
    pthread_mutex_t mutex;
    pthread_cond_t changed;
    bool stop;
    uint32_t thread_count; // started
    pthread_t threads[ENCODE_MAX_WORKERS];
    uint32_t first, count;
    struct job *jobs[MAX_JOBS];
};

// `memory` is what the thread keeps for the codec; made when first needed.
static struct encoded_frame *encode(void **memory, const struct job *job, int quality)
{
    const struct frame_encoder *encoder = frame_encoder_of(job->header.codec);
    uint64_t start = clock_now_us();
    if (!*memory)
        *memory = encoder->create();
    size_t bytes = 0;
    const uint8_t *image = *memory ? encoder->encode(*memory, &job->image, quality, &bytes) : NULL;
    struct encoded_frame *frame =
        image ? malloc(sizeof(*frame) + FRAME_STREAM_PREFIX_BYTES + FRAME_HEADER_BYTES + bytes)
              : NULL;
    if (!frame)
        return NULL;
    memcpy(frame->bytes + FRAME_STREAM_PREFIX_BYTES + FRAME_HEADER_BYTES, image, bytes);
    frame->message_bytes = FRAME_HEADER_BYTES + bytes;
    frame->encoded_at_us = clock_now_us();
    frame->header = job->header;
    frame->header.jpeg_bytes = (uint32_t)bytes;
    frame->header.encode_us = (uint32_t)(frame->encoded_at_us - start);
    return frame;
}

static struct job *take_job(struct encode_workers *workers)
{
    struct job *job = NULL;
    pthread_mutex_lock(&workers->mutex);
    while (!workers->stop && workers->count == 0)
        pthread_cond_wait(&workers->changed, &workers->mutex);
    if (!workers->stop) {
        job = workers->jobs[workers->first];
        workers->first = (workers->first + 1) % MAX_JOBS;
        workers->count--;
    }
    pthread_mutex_unlock(&workers->mutex);
    return job;
}

static void *work(void *user)
{
    struct encode_workers *workers = user;
    void *memories[FRAME_CODEC_COUNT] = {NULL};
    for (struct job *job = take_job(workers); job; job = take_job(workers)) {
        frame_stream_finish(workers->params.stream, job->slot,
                            encode(&memories[job->header.codec], job, workers->params.quality));
        free(job);
    }
    for (uint32_t i = 0; i < FRAME_CODEC_COUNT; i++)
        if (memories[i])
            frame_encoder_of(i)->destroy(memories[i]);
    return NULL;
}

struct encode_workers *encode_workers_create(const struct encode_workers_params *params)
{
    struct encode_workers *workers = calloc(1, sizeof(*workers));
    if (!workers)
        return NULL;
    workers->params = *params;
    pthread_mutex_init(&workers->mutex, NULL);
    pthread_cond_init(&workers->changed, NULL);
    for (uint32_t i = 0; i < params->thread_count; i++) {
        if (pthread_create(&workers->threads[i], NULL, work, workers) != 0) {
            encode_workers_destroy(&workers);
            return NULL;
        }
        workers->thread_count++;
    }
    return workers;
}

void encode_workers_destroy(struct encode_workers **workers)
{
    struct encode_workers *w = *workers;
    if (!w)
        return;
    pthread_mutex_lock(&w->mutex);
    w->stop = true;
    pthread_cond_broadcast(&w->changed);
    pthread_mutex_unlock(&w->mutex);
    for (uint32_t i = 0; i < w->thread_count; i++)
        pthread_join(w->threads[i], NULL);
    for (uint32_t i = 0; i < w->count; i++) {
        struct job *job = w->jobs[(w->first + i) % MAX_JOBS];
        frame_stream_finish(w->params.stream, job->slot, NULL);
        free(job);
    }
    pthread_cond_destroy(&w->changed);
    pthread_mutex_destroy(&w->mutex);
    free(w);
    *workers = NULL;
}

static struct job *create_job(uint32_t slot, const struct frame_header *header,
                              const struct frame_pixels *pixels)
{
    size_t sizes[3];
    for (int i = 0; i < 3; i++) {
        uint32_t rows = i == 0 ? pixels->height : (pixels->height + 1) / 2;
        sizes[i] = (size_t)pixels->row_pitch_bytes[i] * rows;
    }
    struct job *job = malloc(sizeof(*job) + sizes[0] + sizes[1] + sizes[2]);
    if (!job)
        return NULL;
    job->slot = slot;
    job->header = *header;
    job->header.width = (uint16_t)pixels->width;
    job->header.height = (uint16_t)pixels->height;
    job->image.width = job->header.width;
    job->image.height = job->header.height;
    uint8_t *at = job->bytes;
    for (int i = 0; i < 3; i++) {
        // The last row may be shorter than the pitch.
        uint32_t row_bytes = i == 0 ? pixels->width : (pixels->width + 1) / 2;
        memcpy(at, pixels->planes[i], sizes[i] - pixels->row_pitch_bytes[i] + row_bytes);
        job->image.planes[i] = at;
        job->image.pitches[i] = (int)pixels->row_pitch_bytes[i];
        at += sizes[i];
    }
    return job;
}

void encode_workers_submit(struct encode_workers *workers, uint32_t slot,
                           const struct frame_header *header, const struct frame_pixels *pixels)
{
    struct job *job = create_job(slot, header, pixels);
    pthread_mutex_lock(&workers->mutex);
    if (job && workers->count < MAX_JOBS) {
        workers->jobs[(workers->first + workers->count++) % MAX_JOBS] = job;
        pthread_cond_signal(&workers->changed);
        slot = UINT32_MAX;
    }
    pthread_mutex_unlock(&workers->mutex);
    if (slot != UINT32_MAX) {
        free(job);
        frame_stream_finish(workers->params.stream, slot, NULL);
    }
}
