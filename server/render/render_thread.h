// The thread that owns the renderer, the scene document and all edits.
#ifndef VOXCAST_SERVER_RENDER_RENDER_THREAD_H
#define VOXCAST_SERVER_RENDER_RENDER_THREAD_H

#include <stdbool.h>
#include <stdint.h>

#include "server/render/accuracy_service.h"
#include "server/stream/frame_stream.h"
#include "server/stream/encode_workers.h"
#include "server/stream/mailbox.h"
#include "server/stream/outbox.h"

struct render_thread;

// All must outlive the thread.
struct render_thread_params {
    const char *gpu;
    const char *scene_source; // path or "builtin:NAME"
    const char *environment;  // for that scene; NULL for its own
    const char *scene_dir;    // where clients may load scenes from; NULL for none
    uint32_t message_bytes, message_rate, max_clients; // reported to clients
    struct mailbox *mailbox;
    struct outbox *outbox;
    struct frame_stream *stream;
    struct encode_workers *workers;
    struct accuracy_service *accuracy;
    // The thread calls it when it cannot go on: no renderer, or the first scene fails.
    void (*failed)(void *user);
    void *user;
};

struct render_status {
    bool failed;
    bool ready; // a scene is shown
    char gl_renderer[128];
    char scene[256];
    uint64_t frames_drawn;
    uint64_t draw_us; // sum, from the draw call to the pixels
    uint64_t revision;
};

// NULL when out of memory or threads.
struct render_thread *render_thread_start(const struct render_thread_params *params);

// Asks the thread to end after its present work; does not wait. Any thread.
void render_thread_stop(struct render_thread *thread);

// Stops and joins.
void render_thread_destroy(struct render_thread **thread);

// Any thread.
void render_thread_get_status(struct render_thread *thread, struct render_status *out_status);

#endif
