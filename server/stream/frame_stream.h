// Where the three kinds of threads exchange frames: one slot for each client.
//
// The network loop opens and closes slots, takes encoded frames and reports acknowledgements. The
// render thread asks which client may have another frame. Workers that encode hand in frames. Each
// call holds one mutex briefly; a slow client delays nobody.
#ifndef VOXCAST_SERVER_STREAM_FRAME_STREAM_H
#define VOXCAST_SERVER_STREAM_FRAME_STREAM_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "protocol/frame_header.h"

#define FRAME_STREAM_MAX_CLIENTS        64u
#define FRAME_STREAM_MAX_UNACKNOWLEDGED 2u
#define FRAME_STREAM_PREFIX_BYTES       32u // room for the WebSocket header before a message

struct frame_stream;

// A message ready to be sent: FRAME_STREAM_PREFIX_BYTES unused bytes, the header, the image.
struct encoded_frame {
    struct frame_header header; // written into the message when the frame is sent
    uint64_t encoded_at_us;
    size_t message_bytes; // header and image
    uint8_t bytes[];
};

struct stage_times {
    double encode_ms, send_wait_ms, acknowledge_ms; // running averages
    uint32_t jpeg_bytes;                            // of the newest
};

struct frame_stream_totals {
    uint32_t client_count;
    uint64_t frames_sent, frames_dropped, bytes_sent;
    uint64_t encode_us;
};

// Called when a client's slot holds a frame to send (network), or when a client may have another
// frame or has gone (render). No locks are held then.
struct frame_stream_params {
    uint32_t max_clients;
    void (*wake_network)(void *user);
    void (*wake_render)(void *user);
    void *user;
};

struct frame_stream *frame_stream_create(const struct frame_stream_params *params);
void frame_stream_destroy(struct frame_stream **stream);

// Network loop. False when all slots are taken. Client ids count up from 1.
bool frame_stream_open(struct frame_stream *stream, uint32_t *out_slot, uint32_t *out_client_id);
bool frame_stream_is_full(struct frame_stream *stream);
void frame_stream_close(struct frame_stream *stream, uint32_t slot);

// Network loop. The frame to send now, which the caller frees, or NULL if there is none or two are
// unacknowledged. Its header is complete and written.
struct encoded_frame *frame_stream_take(struct frame_stream *stream, uint32_t slot);
bool frame_stream_has_frame(struct frame_stream *stream, uint32_t slot); // that can be sent
void frame_stream_acknowledge(struct frame_stream *stream, uint32_t slot, uint64_t frame_id);

// Render thread. The id of the client in the slot; 0 if it is free or its client has gone.
uint32_t frame_stream_get_client(struct frame_stream *stream, uint32_t slot);

// Render thread. Frees the slots of clients that have gone, once the workers have finished their
// frames.
void frame_stream_collect_closed(struct frame_stream *stream);

// Render thread. Whether to draw for this client; and that a frame was drawn and will be finished.
bool frame_stream_wants_frame(struct frame_stream *stream, uint32_t slot);
void frame_stream_begin(struct frame_stream *stream, uint32_t slot);

// Any thread, once for each begin. Takes over `frame`; NULL if encoding failed. Replaces a frame
// that waits.
void frame_stream_finish(struct frame_stream *stream, uint32_t slot, struct encoded_frame *frame);

void frame_stream_get_times(struct frame_stream *stream, uint32_t slot,
                            struct stage_times *out_times);
void frame_stream_get_totals(struct frame_stream *stream, struct frame_stream_totals *out_totals);

#endif
