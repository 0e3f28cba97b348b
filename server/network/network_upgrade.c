// Who may open a WebSocket: checks the kind of upgrade, the origin, the token and the number of
// clients.
#include "server/network/network_internal.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "protocol/limits.h"

static bool tokens_equal(const char *expected, const char *given)
{
    size_t length = strlen(given);
    size_t expected_length = strlen(expected);
    unsigned char difference = length != expected_length;
    // Reads all of `expected` whatever `given` is, so that the time tells nothing.
    for (size_t i = 0; i < expected_length; i++)
        difference |= (unsigned char)(expected[i] ^ given[length > 0 ? i % length : 0]);
    return difference == 0;
}

enum role network_check_token(const struct network *network, const char *token)
{
    if (network->params.token[0] && tokens_equal(network->params.token, token))
        return ROLE_EDITOR;
    if (network->params.viewer_token[0] && tokens_equal(network->params.viewer_token, token))
        return ROLE_VIEWER;
    return ROLE_NONE;
}

bool network_get_query(struct lws *wsi, const char *name, char *out, size_t size)
{
    char prefix[32];
    snprintf(prefix, sizeof(prefix), "%s=", name);
    char fragment[1024];
    size_t length = strlen(prefix);
    for (int i = 0;
         lws_hdr_copy_fragment(wsi, fragment, sizeof(fragment), WSI_TOKEN_HTTP_URI_ARGS, i) >= 0;
         i++) {
        if (strncmp(fragment, prefix, length) == 0 && strlen(fragment + length) < size) {
            strcpy(out, fragment + length);
            return true;
        }
    }
    return false;
}

// Whether `origin` is in a list separated by commas.
static bool is_listed(const char *list, const char *origin)
{
    size_t length = strlen(origin);
    while (*list) {
        list += strspn(list, ", ");
        size_t item = strcspn(list, ", ");
        if (item == length && strncasecmp(list, origin, length) == 0)
            return true;
        list += item;
    }
    return false;
}

// The page's origin must be the server itself or an allowed one. A program sends no origin.
static bool origin_is_allowed(const struct network *network, struct lws *wsi)
{
    if (lws_hdr_total_length(wsi, WSI_TOKEN_ORIGIN) == 0)
        return true;
    char origin[512], host[512];
    if (lws_hdr_copy(wsi, origin, sizeof(origin), WSI_TOKEN_ORIGIN) <= 0)
        return false;
    if (is_listed(network->params.allow_origin, origin))
        return true;
    if (lws_hdr_copy(wsi, host, sizeof(host), WSI_TOKEN_HOST) <= 0)
        return false;
    const char *after_scheme = strstr(origin, "://");
    return after_scheme && strcasecmp(after_scheme + 3, host) == 0;
}

static bool asks_for_subprotocol(struct lws *wsi)
{
    char list[256];
    return lws_hdr_copy(wsi, list, sizeof(list), WSI_TOKEN_PROTOCOL) > 0 &&
           is_listed(list, PROTOCOL_SUBPROTOCOL);
}

static bool refuse(struct lws *wsi, unsigned int status, const char *reason)
{
    log_write(LOG_WARN, "upgrade_refused status=%u reason=\"%s\"", status, reason);
    lws_return_http_status(wsi, status, reason);
    return false;
}

bool network_check_upgrade(struct network *network, struct lws *wsi)
{
    char kind[32];
    // The library answers unknown kinds of upgrade itself. On a kept-alive connection it calls here
    // nevertheless, with headers that it has freed already: then none are found and nothing is
    // sent.
    if (lws_hdr_copy(wsi, kind, sizeof(kind), WSI_TOKEN_UPGRADE) <= 0 ||
        strcasecmp(kind, "websocket") != 0)
        return false;
    if (atomic_load(&network->draining))
        return refuse(wsi, HTTP_STATUS_SERVICE_UNAVAILABLE, "the server goes away");
    if (!origin_is_allowed(network, wsi))
        return refuse(wsi, HTTP_STATUS_FORBIDDEN, "this origin is not allowed");
    if (!asks_for_subprotocol(wsi))
        return refuse(wsi, HTTP_STATUS_BAD_REQUEST, "the subprotocol is " PROTOCOL_SUBPROTOCOL);
    char token[PROTOCOL_MAX_TOKEN_BYTES + 1];
    if ((network->params.token[0] || network->params.viewer_token[0]) &&
        network_get_query(wsi, "token", token, sizeof(token)) &&
        network_check_token(network, token) == ROLE_NONE)
        return refuse(wsi, HTTP_STATUS_UNAUTHORIZED, "the token is wrong");
    if (frame_stream_is_full(network->params.stream))
        return refuse(wsi, HTTP_STATUS_SERVICE_UNAVAILABLE, "too many clients");
    return true;
}
