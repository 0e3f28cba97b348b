// Threads that encode planes of pixels as frames, by the codec that the header names. They work on
// copies of the planes.
#ifndef VOXCAST_SERVER_STREAM_ENCODE_WORKERS_H
#define VOXCAST_SERVER_STREAM_ENCODE_WORKERS_H

#include <stdint.h>

#include "renderer/renderer.h"
#include "server/stream/frame_stream.h"

#define ENCODE_MAX_WORKERS 16u

struct encode_workers;

struct encode_workers_params {
    uint32_t thread_count;       // 1 to ENCODE_MAX_WORKERS
    int quality;                 // 1 to 100
    struct frame_stream *stream; // must outlive the workers
};

// NULL when out of memory or threads.
struct encode_workers *encode_workers_create(const struct encode_workers_params *params);

// Finishes the jobs at hand, drops those that wait, and joins the threads.
void encode_workers_destroy(struct encode_workers **workers);

// Copies the planes (FRAME_OUTPUT_YCBCR) and queues them for a worker. The worker fills in the
// header's sizes and encode time and calls frame_stream_finish() for the slot, also on failure.
// Runs on the render thread.
void encode_workers_submit(struct encode_workers *workers, uint32_t slot,
                           const struct frame_header *header, const struct frame_pixels *pixels);

#endif
