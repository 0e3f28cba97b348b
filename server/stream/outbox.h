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
    char *text; // from malloc, the receiver's
};

// `wake` is called after a message was put into an empty outbox, from the thread that posts.
struct outbox_params {
    void (*wake)(void *user);
    void *user;
};

struct outbox *outbox_create(const struct outbox_params *params);
void outbox_destroy(struct outbox **outbox);

// Takes over `text` (NULL, from a failed allocation, is passed over). Blocks while the outbox is
// full and not closed: the network loop never waits for the caller. Any thread.
void outbox_post(struct outbox *outbox, uint32_t client_id, char *text);

// False if there is none.
bool outbox_take(struct outbox *outbox, struct outbox_message *out_message);

// From now on posts are dropped: nobody takes them any more.
void outbox_close(struct outbox *outbox);

#endif
