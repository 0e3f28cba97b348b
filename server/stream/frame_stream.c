#include "server/stream/frame_stream.h"

#include <pthread.h>
#include <stdlib.h>

#include "renderer/clock.h"

enum slot_state { SLOT_FREE, SLOT_OPEN, SLOT_CLOSED };

struct sent_frame {
    uint64_t frame_id;
    uint64_t sent_at_us;
};

struct slot {
    enum slot_state state;
    uint32_t client_id;
    uint32_t in_work; // begun, but not finished
    struct encoded_frame *pending;
    uint32_t sent_count;
    struct sent_frame sent[FRAME_STREAM_MAX_UNACKNOWLEDGED]; // unacknowledged, oldest first
    struct stage_times times;
};

struct frame_stream {
    struct frame_stream_params params;
    pthread_mutex_t mutex;
    uint32_t newest_client_id;
    struct frame_stream_totals totals;
    struct slot slots[FRAME_STREAM_MAX_CLIENTS];
};

struct frame_stream *frame_stream_create(const struct frame_stream_params *params)
{
    struct frame_stream *stream = calloc(1, sizeof(*stream));
    if (!stream)
        return NULL;
    stream->params = *params;
    pthread_mutex_init(&stream->mutex, NULL);
    return stream;
}

void frame_stream_destroy(struct frame_stream **stream)
{
    if (!*stream)
        return;
    for (uint32_t i = 0; i < FRAME_STREAM_MAX_CLIENTS; i++)
        free((*stream)->slots[i].pending);
    pthread_mutex_destroy(&(*stream)->mutex);
    free(*stream);
    *stream = NULL;
}

static struct slot *lock_slot(struct frame_stream *stream, uint32_t slot)
{
    pthread_mutex_lock(&stream->mutex);
    return &stream->slots[slot];
}

static void unlock(struct frame_stream *stream)
{
    pthread_mutex_unlock(&stream->mutex);
}

static void average(double *value, uint64_t sample_us)
{
    *value += 0.2 * ((double)sample_us / 1000.0 - *value);
}

bool frame_stream_open(struct frame_stream *stream, uint32_t *out_slot, uint32_t *out_client_id)
{
    pthread_mutex_lock(&stream->mutex);
    bool found = false;
    if (stream->totals.client_count < stream->params.max_clients) {
        for (uint32_t i = 0; i < FRAME_STREAM_MAX_CLIENTS && !found; i++) {
            if (stream->slots[i].state != SLOT_FREE)
                continue;
            stream->slots[i] =
                (struct slot){.state = SLOT_OPEN, .client_id = ++stream->newest_client_id};
            stream->totals.client_count++;
            *out_slot = i;
            *out_client_id = stream->newest_client_id;
            found = true;
        }
    }
    unlock(stream);
    return found;
}

bool frame_stream_is_full(struct frame_stream *stream)
{
    pthread_mutex_lock(&stream->mutex);
    bool full = stream->totals.client_count >= stream->params.max_clients;
    unlock(stream);
    return full;
}

void frame_stream_close(struct frame_stream *stream, uint32_t slot_index)
{
    struct slot *slot = lock_slot(stream, slot_index);
    slot->state = SLOT_CLOSED;
    free(slot->pending);
    slot->pending = NULL;
    stream->totals.client_count--;
    unlock(stream);
    stream->params.wake_render(stream->params.user);
}

struct encoded_frame *frame_stream_take(struct frame_stream *stream, uint32_t slot_index)
{
    struct slot *slot = lock_slot(stream, slot_index);
    struct encoded_frame *frame = NULL;
    if (slot->pending && slot->sent_count < FRAME_STREAM_MAX_UNACKNOWLEDGED) {
        frame = slot->pending;
        slot->pending = NULL;
        uint64_t now = clock_now_us();
        frame->header.sent_at_us = now;
        frame->header.send_wait_us = (uint32_t)(now - frame->encoded_at_us);
        average(&slot->times.send_wait_ms, now - frame->encoded_at_us);
        slot->sent[slot->sent_count++] = (struct sent_frame){frame->header.frame_id, now};
        stream->totals.frames_sent++;
        stream->totals.bytes_sent += frame->message_bytes;
    }
    unlock(stream);
    if (frame)
        frame_header_encode(&frame->header, frame->bytes + FRAME_STREAM_PREFIX_BYTES);
    return frame;
}

bool frame_stream_has_frame(struct frame_stream *stream, uint32_t slot_index)
{
    struct slot *slot = lock_slot(stream, slot_index);
    bool has = slot->pending && slot->sent_count < FRAME_STREAM_MAX_UNACKNOWLEDGED;
    unlock(stream);
    return has;
}

void frame_stream_acknowledge(struct frame_stream *stream, uint32_t slot_index, uint64_t frame_id)
{
    struct slot *slot = lock_slot(stream, slot_index);
    uint32_t acknowledged = 0;
    while (acknowledged < slot->sent_count && slot->sent[acknowledged].frame_id <= frame_id) {
        average(&slot->times.acknowledge_ms, clock_now_us() - slot->sent[acknowledged].sent_at_us);
        acknowledged++;
    }
    slot->sent_count -= acknowledged;
    for (uint32_t i = 0; i < slot->sent_count; i++)
        slot->sent[i] = slot->sent[i + acknowledged];
    bool has_frame = slot->pending != NULL;
    unlock(stream);
    if (acknowledged > 0)
        stream->params.wake_render(stream->params.user);
    if (acknowledged > 0 && has_frame)
        stream->params.wake_network(stream->params.user);
}

uint32_t frame_stream_get_client(struct frame_stream *stream, uint32_t slot_index)
{
    struct slot *slot = lock_slot(stream, slot_index);
    uint32_t client_id = slot->state == SLOT_OPEN ? slot->client_id : 0;
    unlock(stream);
    return client_id;
}

void frame_stream_collect_closed(struct frame_stream *stream)
{
    pthread_mutex_lock(&stream->mutex);
    for (uint32_t i = 0; i < FRAME_STREAM_MAX_CLIENTS; i++) {
        struct slot *slot = &stream->slots[i];
        if (slot->state == SLOT_CLOSED && slot->in_work == 0)
            slot->state = SLOT_FREE;
    }
    unlock(stream);
}

bool frame_stream_wants_frame(struct frame_stream *stream, uint32_t slot_index)
{
    struct slot *slot = lock_slot(stream, slot_index);
    uint32_t in_flight = slot->in_work + slot->sent_count + (slot->pending ? 1 : 0);
    bool wants = slot->state == SLOT_OPEN && in_flight < FRAME_STREAM_MAX_UNACKNOWLEDGED;
    unlock(stream);
    return wants;
}

void frame_stream_begin(struct frame_stream *stream, uint32_t slot_index)
{
    struct slot *slot = lock_slot(stream, slot_index);
    slot->in_work++;
    unlock(stream);
}

void frame_stream_finish(struct frame_stream *stream, uint32_t slot_index,
                         struct encoded_frame *frame)
{
    struct slot *slot = lock_slot(stream, slot_index);
    slot->in_work--;
    bool open = slot->state == SLOT_OPEN;
    struct encoded_frame *dropped = frame;
    if (open && frame) {
        average(&slot->times.encode_ms, frame->header.encode_us);
        slot->times.jpeg_bytes = frame->header.jpeg_bytes;
        stream->totals.encode_us += frame->header.encode_us;
        dropped = slot->pending;
        slot->pending = frame;
        stream->totals.frames_dropped += dropped != NULL;
    }
    unlock(stream);
    free(dropped);
    if (open && frame)
        stream->params.wake_network(stream->params.user);
    else
        stream->params.wake_render(stream->params.user);
}

void frame_stream_get_times(struct frame_stream *stream, uint32_t slot_index,
                            struct stage_times *out_times)
{
    struct slot *slot = lock_slot(stream, slot_index);
    *out_times = slot->times;
    unlock(stream);
}

void frame_stream_get_totals(struct frame_stream *stream, struct frame_stream_totals *out_totals)
{
    pthread_mutex_lock(&stream->mutex);
    *out_totals = stream->totals;
    unlock(stream);
}
