// The network loop: owns sockets and sessions, and serves HTTP and WebSocket on one port.
//
// It checks and parses messages and posts them to the render thread; it never waits for anyone.
#ifndef VOXCAST_SERVER_NETWORK_NETWORK_H
#define VOXCAST_SERVER_NETWORK_NETWORK_H

#include <stdbool.h>
#include <stdint.h>

#include "renderer/renderer.h"
#include "server/render/accuracy_service.h"
#include "server/stream/frame_stream.h"
#include "server/stream/mailbox.h"
#include "server/stream/outbox.h"
#include "server/render/render_thread.h"

struct network;

// Pointers must outlive the network.
struct network_params {
    const char *listen;
    uint32_t port;
    const char *web_dir;
    const char *allow_origin; // origins, separated by commas
    const char *token;        // "" for none: then whoever brings none is an editor
    const char *viewer_token; // "" for none
    uint32_t message_bytes;
    uint32_t queue_bytes; // limit of texts that wait for one client
    uint32_t message_rate;
    struct mailbox *mailbox;
    struct frame_stream *stream;
    struct accuracy_service *accuracy; // its files are served
};

// Binds the port. NULL with a message that names the address.
struct network *network_create(const struct network_params *params, struct error *out_error);

// The port in use.
uint32_t network_get_port(const struct network *network);

// Starts the serving thread, which takes messages from `outbox`. `render` answers /readyz. False if
// the thread cannot start.
bool network_start(struct network *network, struct outbox *outbox, struct render_thread *render);

// Makes the loop look at the outbox and at frames. Any thread; `user` is the network.
void network_wake(void *user);

// Tells all clients that the server goes away, then stops and joins the thread. A client that does
// not answer delays this by a second at most.
void network_stop(struct network *network);

void network_destroy(struct network **network);

#endif
