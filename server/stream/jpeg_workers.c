#include "server/stream/jpeg_workers.h"

#include <pthread.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include <turbojpeg.h>

#include "renderer/clock.h"

// Credits bound the jobs: FRAME_STREAM_MAX_UNACKNOWLEDGED for each client.
#define MAX_JOBS (FRAME_STREAM_MAX_CLIENTS * FRAME_STREAM_MAX_UNACKNOWLEDGED)

struct job {
    uint32_t slot;
    struct frame_header header;
    const uint8_t *planes[3]; // into bytes
    int pitches[3];
    uint8_t bytes[];
};

struct jpeg_workers {
    struct jpeg_workers_params params;
    pthread_mutex_t mutex;
    pthread_cond_t changed;
    bool stop;
    uint32_t thread_count; // started
    pthread_t threads[JPEG_MAX_WORKERS];
    uint32_t first, count;
    struct job *jobs[MAX_JOBS];
};

// What a thread keeps between jobs.
struct encoder {
    tjhandle handle;
    unsigned char *buffer;
    unsigned long size;
};

static struct encoded_frame *encode(struct encoder *encoder, const struct job *job, int quality)
{
    int width = job->header.width, height = job->header.height;
    unsigned long needed = tjBufSize(width, height, TJSAMP_420);
    if (needed > encoder->size) {
        free(encoder->buffer);
        encoder->buffer = malloc(needed);
        encoder->size = encoder->buffer ? needed : 0;
    }
    if (!encoder->handle || !encoder->buffer)
        return NULL;
    uint64_t start = clock_now_us();
    unsigned long bytes = encoder->size;
    const unsigned char *planes[3] = {job->planes[0], job->planes[1], job->planes[2]};
    if (tjCompressFromYUVPlanes(encoder->handle, planes, width, job->pitches, height, TJSAMP_420,
                                &encoder->buffer, &bytes, quality,
                                TJFLAG_NOREALLOC | TJFLAG_FASTDCT) != 0) {
        log_write(LOG_ERROR, "jpeg_failed width=%d height=%d reason=\"%s\"", width, height,
                  tjGetErrorStr2(encoder->handle));
        return NULL;
    }
    struct encoded_frame *frame =
        malloc(sizeof(*frame) + FRAME_STREAM_PREFIX_BYTES + FRAME_HEADER_BYTES + bytes);
    if (!frame)
        return NULL;
    memcpy(frame->bytes + FRAME_STREAM_PREFIX_BYTES + FRAME_HEADER_BYTES, encoder->buffer, bytes);
    frame->message_bytes = FRAME_HEADER_BYTES + bytes;
    frame->encoded_at_us = clock_now_us();
    frame->header = job->header;
    frame->header.jpeg_bytes = (uint32_t)bytes;
    frame->header.encode_us = (uint32_t)(frame->encoded_at_us - start);
    return frame;
}

static struct job *take_job(struct jpeg_workers *workers)
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
    struct jpeg_workers *workers = user;
    struct encoder encoder = {.handle = tjInitCompress()};
    for (struct job *job = take_job(workers); job; job = take_job(workers)) {
        frame_stream_finish(workers->params.stream, job->slot,
                            encode(&encoder, job, workers->params.quality));
        free(job);
    }
    free(encoder.buffer);
    if (encoder.handle)
        tjDestroy(encoder.handle);
    return NULL;
}

struct jpeg_workers *jpeg_workers_create(const struct jpeg_workers_params *params)
{
    struct jpeg_workers *workers = calloc(1, sizeof(*workers));
    if (!workers)
        return NULL;
    workers->params = *params;
    pthread_mutex_init(&workers->mutex, NULL);
    pthread_cond_init(&workers->changed, NULL);
    for (uint32_t i = 0; i < params->thread_count; i++) {
        if (pthread_create(&workers->threads[i], NULL, work, workers) != 0) {
            jpeg_workers_destroy(&workers);
            return NULL;
        }
        workers->thread_count++;
    }
    return workers;
}

void jpeg_workers_destroy(struct jpeg_workers **workers)
{
    struct jpeg_workers *w = *workers;
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
    uint8_t *at = job->bytes;
    for (int i = 0; i < 3; i++) {
        // The last row may be shorter than the pitch.
        uint32_t row_bytes = i == 0 ? pixels->width : (pixels->width + 1) / 2;
        memcpy(at, pixels->planes[i], sizes[i] - pixels->row_pitch_bytes[i] + row_bytes);
        job->planes[i] = at;
        job->pitches[i] = (int)pixels->row_pitch_bytes[i];
        at += sizes[i];
    }
    return job;
}

void jpeg_workers_submit(struct jpeg_workers *workers, uint32_t slot,
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
