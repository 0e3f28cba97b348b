// What the files of the network loop share. Everything here runs on its thread.
#ifndef VOXCAST_SERVER_NETWORK_NETWORK_INTERNAL_H
#define VOXCAST_SERVER_NETWORK_NETWORK_INTERNAL_H

#include <pthread.h>
#include <stdatomic.h>

#include <cjson/cJSON.h>
#include <libwebsockets.h>

#include "protocol/rpc.h"
#include "server/network/network.h"

#define SESSION_HELLO_SECONDS   10
#define SESSION_MAX_RATE_ERRORS 400u

enum close_code {
    CLOSE_GOING_AWAY = 1001,
    CLOSE_NOT_TEXT = 1003,
    CLOSE_TOO_LARGE = 1009,
    CLOSE_WRONG_TOKEN = 4401,
    CLOSE_NO_HELLO = 4408,
    CLOSE_TOO_SLOW = 4413,
    CLOSE_TOO_MANY = 4429,
};

// A text to send; sessions share it when it goes to all clients.
struct text {
    uint32_t references;
    size_t length;
    unsigned char bytes[]; // LWS_PRE unused, then the text
};

struct text_link {
    struct text *text;
    struct text_link *next;
};

enum role { ROLE_NONE, ROLE_VIEWER, ROLE_EDITOR };

// One WebSocket connection.
struct session {
    struct network *network;
    struct lws *wsi;
    struct session *next;
    uint32_t slot;
    uint32_t client_id;
    enum role role; // ROLE_NONE until a token came, if one is required
    bool said_hello;
    char *message; // assembled from fragments; owned
    size_t message_length;
    double tokens; // of the rate limiter
    uint64_t tokens_at_us;
    uint32_t rate_errors;
    struct text_link *first, *last; // to send; owned
    size_t queued_bytes;
    int close_code; // 0: stays open
    bool close_due; // the close message may be sent
    const char *close_reason;
};

struct network {
    struct network_params params;
    struct outbox *outbox;
    struct render_thread *render;
    struct lws_context *context;
    struct lws_vhost *vhost;
    char web_root[4096]; // canonical; "" if there is none
    pthread_t thread;
    bool started;
    atomic_bool draining; // no new connections; sessions are told that the server goes away
    atomic_bool stop;
    struct session *sessions;
};

// network_session.c: callbacks of the protocol voxcast.v1.
int network_session_callback(struct lws *wsi, enum lws_callback_reasons reason, void *user,
                             void *in, size_t length);
void session_send(struct session *session, struct text *text); // takes a reference of its own
void session_close(struct session *session, int code, const char *reason);

struct text *text_create(const char *content); // one reference; NULL when out of memory
void text_release(struct text *text);          // NULL is fine

// network_http.c
int network_http_callback(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in,
                          size_t length);

// network_upgrade.c: checks a request for an upgrade to WebSocket. False if it was refused and
// answered: the caller hangs up.
bool network_check_upgrade(struct network *network, struct lws *wsi);

// The role that a token gives; ROLE_NONE for a wrong one. Takes the same time wherever the token
// differs.
enum role network_check_token(const struct network *network, const char *token);

// Copies the decoded value of a query argument; false if it is missing or does not fit.
bool network_get_query(struct lws *wsi, const char *name, char *out, size_t size);

#endif
