// Text messages from the render thread to the network loop: bounded, in order, none lost.
#ifndef VOXCAST_SERVER_STREAM_OUTBOX_H
#define VOXCAST_SERVER_STREAM_OUTBOX_H

#include <stdbool.h>
#include <stdint.h>

#define OUTBOX_CAPACITY 1024u
#define OUTBOX_TO_ALL   0u // instead of a client id: every client that has said hello

struct outbox;

struct outbox_message {
    uint32_t client_id;
    char *text; // from malloc; the receiver frees it
};

// The posting thread calls `wake` after putting a message into an empty outbox.
struct outbox_params {
    void (*wake)(void *user);
    void *user;
};

struct outbox *outbox_create(const struct outbox_params *params);
void outbox_destroy(struct outbox **outbox);

// Takes over `text` (NULL, from a failed allocation, is ignored). Blocks while the outbox is full
// and not closed; this cannot deadlock, since the network loop never waits for the caller. Any
// thread.
void outbox_post(struct outbox *outbox, uint32_t client_id, char *text);

// False if there is none.
bool outbox_take(struct outbox *outbox, struct outbox_message *out_message);

// Drops all further posts, since nobody takes them any more.
void outbox_close(struct outbox *outbox);

#endif
