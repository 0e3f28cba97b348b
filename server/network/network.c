#include "server/network/network.h"

#include <arpa/inet.h>
#include <assert.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "renderer/clock.h"
#include "server/network/network_internal.h"

#define SERVICE_BUFFER_BYTES (256u << 10)
#define RECEIVE_BYTES        4096u
#define DRAIN_US             400000u

static const struct lws_protocols protocols[] = {
    {.name = "http", .callback = network_http_callback, .rx_buffer_size = RECEIVE_BYTES},
    {.name = PROTOCOL_SUBPROTOCOL,
     .callback = network_session_callback,
     .per_session_data_size = sizeof(struct session),
     .rx_buffer_size = RECEIVE_BYTES,
     .tx_packet_size = SERVICE_BUFFER_BYTES},
    {0},
};

// A client that is silent for a minute is probed, and dropped if it does not answer.
static const lws_retry_bo_t probing = {.secs_since_valid_ping = 60, .secs_since_valid_hangup = 80};

static void log_library(int level, const char *line)
{
    log_write(level == LLL_ERR ? LOG_WARN : LOG_DEBUG, "websockets text=\"%.*s\"",
              (int)strcspn(line, "\n"), line);
}

static_assert(LWS_PRE <= FRAME_STREAM_PREFIX_BYTES, "frames leave room for the library's header");

// Why an address and port cannot be bound, as an errno; 0 if they can, or if the address is the
// name of an interface.
static int find_bind_error(const char *address, uint32_t port)
{
    struct sockaddr_in ipv4 = {.sin_family = AF_INET, .sin_port = htons((uint16_t)port)};
    struct sockaddr_in6 ipv6 = {.sin6_family = AF_INET6, .sin6_port = htons((uint16_t)port)};
    bool is_ipv4 = inet_pton(AF_INET, address, &ipv4.sin_addr) == 1;
    if (!is_ipv4 && inet_pton(AF_INET6, address, &ipv6.sin6_addr) != 1)
        return 0;
    int fd = socket(is_ipv4 ? AF_INET : AF_INET6, SOCK_STREAM | SOCK_CLOEXEC, 0);
    if (fd < 0)
        return errno;
    setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &(int){1}, sizeof(int));
    int status = is_ipv4 ? bind(fd, (const struct sockaddr *)&ipv4, sizeof(ipv4))
                         : bind(fd, (const struct sockaddr *)&ipv6, sizeof(ipv6));
    int reason = status == 0 && listen(fd, 1) == 0 ? 0 : errno;
    close(fd);
    return reason;
}

static void explain_bind(const struct network_params *params, struct error *out_error)
{
    switch (find_bind_error(params->listen, params->port)) {
    case EADDRINUSE:
        error_set(
            out_error,
            "port %u of %.100s is in use by another program; --port N takes another, --port 0 "
            "a free one",
            params->port, params->listen);
        break;
    case EADDRNOTAVAIL:
        error_set(out_error,
                  "listen is %.100s; allowed are addresses of this machine, such as "
                  "127.0.0.1 or 0.0.0.0 (all)",
                  params->listen);
        break;
    case EACCES:
        error_set(out_error,
                  "port %u is not allowed for this user; --port N takes another, from 1024 on",
                  params->port);
        break;
    default:
        error_set(
            out_error,
            "cannot listen on %.100s port %u: want a free port and an address of this machine",
            params->listen, params->port);
    }
}

struct network *network_create(const struct network_params *params, struct error *out_error)
{
    struct network *network = calloc(1, sizeof(*network));
    if (!network) {
        error_set(out_error, "out of memory");
        return NULL;
    }
    network->params = *params;
    if (params->web_dir[0] && !realpath(params->web_dir, network->web_root))
        log_write(LOG_WARN, "web_client_missing folder=\"%s\"", params->web_dir);
    lws_set_log_level(0, log_library); // errors while it starts are explained below
    // With IPv6 enabled, the library takes an IPv4 address for all addresses of the machine.
    bool ipv4 = !strchr(params->listen, ':');
    struct lws_context_creation_info info = {
        .port = (int)params->port,
        .iface = params->listen,
        .protocols = protocols,
        .user = network,
        .gid = -1,
        .uid = -1,
        .pt_serv_buf_size = SERVICE_BUFFER_BYTES,
        .retry_and_idle_policy = &probing,
        .options = LWS_SERVER_OPTION_EXPLICIT_VHOSTS | LWS_SERVER_OPTION_VALIDATE_UTF8 |
                   LWS_SERVER_OPTION_FAIL_UPON_UNABLE_TO_BIND |
                   (ipv4 ? LWS_SERVER_OPTION_DISABLE_IPV6 : 0),
    };
    network->context = lws_create_context(&info);
    network->vhost = network->context ? lws_create_vhost(network->context, &info) : NULL;
    if (!network->vhost || lws_get_vhost_listen_port(network->vhost) <= 0) {
        explain_bind(params, out_error);
        network_destroy(&network);
    }
    lws_set_log_level(LLL_ERR | LLL_WARN, log_library);
    return network;
}

uint32_t network_get_port(const struct network *network)
{
    return (uint32_t)lws_get_vhost_listen_port(network->vhost);
}

static void deliver(struct network *network, const struct outbox_message *message)
{
    struct text *text = text_create(message->text);
    for (struct session *session = network->sessions; session; session = session->next) {
        if (message->client_id == OUTBOX_TO_ALL ? session->said_hello
                                                : session->client_id == message->client_id)
            session_send(session, text);
    }
    text_release(text);
}

static void deliver_all(struct network *network)
{
    struct outbox_message message;
    while (outbox_take(network->outbox, &message)) {
        deliver(network, &message);
        free(message.text);
    }
    for (struct session *session = network->sessions; session; session = session->next) {
        if (frame_stream_has_frame(network->params.stream, session->slot))
            lws_callback_on_writable(session->wsi);
        if (atomic_load(&network->draining))
            session_close(session, CLOSE_GOING_AWAY, "the server goes away");
    }
}

static void *run(void *user)
{
    struct network *network = user;
    while (!atomic_load(&network->stop)) {
        lws_service(network->context, 0);
        deliver_all(network);
    }
    // A last turn of the loop, in which sessions learn why they end. The library sleeps until
    // something happens; each session's timer or timeout wakes it.
    deliver_all(network);
    uint64_t deadline = clock_now_us() + DRAIN_US;
    while (network->sessions && clock_now_us() < deadline)
        lws_service(network->context, 0);
    return NULL;
}

bool network_start(struct network *network, struct outbox *outbox, struct render_thread *render)
{
    network->outbox = outbox;
    network->render = render;
    network->started = pthread_create(&network->thread, NULL, run, network) == 0;
    return network->started;
}

void network_wake(void *user)
{
    struct network *network = user;
    lws_cancel_service(network->context);
}

void network_stop(struct network *network)
{
    if (!network->started)
        return;
    atomic_store(&network->draining, true);
    atomic_store(&network->stop, true);
    lws_cancel_service(network->context);
    pthread_join(network->thread, NULL);
    network->started = false;
}

void network_destroy(struct network **network)
{
    if (!*network)
        return;
    network_stop(*network);
    if ((*network)->context)
        lws_context_destroy((*network)->context);
    free(*network);
    *network = NULL;
}
