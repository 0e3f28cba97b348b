// HTTP: the web client's files and the endpoints for operators. Every connection serves one request
// and is closed: network_check_upgrade() says why none is kept alive.
#include "server/network/network_internal.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "renderer/process_memory.h"

#define SECURITY_HEADERS                                                                           \
    "x-content-type-options: nosniff\r\n"                                                          \
    "referrer-policy: no-referrer\r\n"                                                             \
    "x-frame-options: DENY\r\n"                                                                    \
    "cross-origin-opener-policy: same-origin\r\n"                                                  \
    "connection: close\r\n"                                                                        \
    "content-security-policy: default-src 'self'; img-src 'self' blob: data:; font-src 'self' "    \
    "data:; worker-src 'self' blob:; style-src 'self' 'unsafe-inline'; connect-src 'self' ws: "    \
    "wss:; object-src 'none'; base-uri 'none'; frame-ancestors 'none'\r\n"

static const char security_headers[] = "cache-control: no-cache\r\n" SECURITY_HEADERS;
// For files that are rewritten again and again, and that not everybody may see.
static const char measured_headers[] = "cache-control: no-store\r\n" SECURITY_HEADERS;

static const char *mime_type(const char *path)
{
    static const struct {
        const char *extension, *type;
    } types[] = {
        {".html", "text/html; charset=utf-8"},
        {".js", "text/javascript; charset=utf-8"},
        {".mjs", "text/javascript; charset=utf-8"},
        {".css", "text/css; charset=utf-8"},
        {".json", "application/json"},
        {".svg", "image/svg+xml"},
        {".png", "image/png"},
        {".jpg", "image/jpeg"},
        {".ico", "image/x-icon"},
        {".woff2", "font/woff2"},
        {".map", "application/json"},
        {".txt", "text/plain; charset=utf-8"},
        {".md", "text/plain; charset=utf-8"},
    };
    const char *dot = strrchr(path, '.');
    for (size_t i = 0; dot && i < sizeof(types) / sizeof(types[0]); i++) {
        if (strcmp(types[i].extension, dot) == 0)
            return types[i].type;
    }
    return NULL;
}

// Sends a small answer at once. Returns what the callback must return so that the connection is
// closed.
static int answer(struct lws *wsi, unsigned int status, const char *type, const char *body)
{
    unsigned char buffer[LWS_PRE + 8192];
    unsigned char *start = buffer + LWS_PRE, *at = start;
    unsigned char *end = buffer + sizeof(buffer) - 1;
    size_t length = strlen(body);
    if (lws_add_http_header_status(wsi, status, &at, end) ||
        lws_add_http_header_by_token(wsi, WSI_TOKEN_HTTP_CONTENT_TYPE, (const unsigned char *)type,
                                     (int)strlen(type), &at, end) ||
        lws_add_http_header_content_length(wsi, length, &at, end))
        return -1;
    size_t headers = sizeof(security_headers) - 1;
    if ((size_t)(end - at) < headers + 2 + length)
        return -1;
    memcpy(at, security_headers, headers);
    at += headers;
    if (lws_finalize_http_header(wsi, &at, end))
        return -1;
    memcpy(at, body, length);
    at += length;
    lws_write(wsi, start, (size_t)(at - start), LWS_WRITE_HTTP_HEADERS);
    return -1;
}

static int answer_ready(struct network *network, struct lws *wsi)
{
    struct render_status status;
    render_thread_get_status(network->render, &status);
    cJSON *object = cJSON_CreateObject();
    bool ready = status.ready && !status.failed;
    cJSON_AddBoolToObject(object, "ready", ready);
    cJSON_AddStringToObject(object, "gl_renderer", status.gl_renderer);
    cJSON_AddStringToObject(object, "scene", status.scene);
    char *body = cJSON_PrintUnformatted(object);
    cJSON_Delete(object);
    int result = answer(wsi, ready ? HTTP_STATUS_OK : HTTP_STATUS_SERVICE_UNAVAILABLE,
                        "application/json", body ? body : "{}");
    free(body);
    return result;
}

static int answer_metrics(struct network *network, struct lws *wsi)
{
    struct render_status status;
    struct frame_stream_totals totals;
    render_thread_get_status(network->render, &status);
    frame_stream_get_totals(network->params.stream, &totals);
    struct process_memory memory = process_memory_read();
    char body[2048];
    snprintf(body, sizeof(body),
             "# TYPE process_resident_memory_bytes gauge\nprocess_resident_memory_bytes %llu\n"
             "# TYPE voxcast_clients gauge\nvoxcast_clients %u\n"
             "# TYPE voxcast_ready gauge\nvoxcast_ready %d\n"
             "# TYPE voxcast_scene_revision counter\nvoxcast_scene_revision %llu\n"
             "# TYPE voxcast_frames_drawn_total counter\nvoxcast_frames_drawn_total %llu\n"
             "# TYPE voxcast_draw_seconds_total counter\nvoxcast_draw_seconds_total %.6f\n"
             "# TYPE voxcast_encode_seconds_total counter\nvoxcast_encode_seconds_total %.6f\n"
             "# TYPE voxcast_frames_sent_total counter\nvoxcast_frames_sent_total %llu\n"
             "# TYPE voxcast_frames_dropped_total counter\nvoxcast_frames_dropped_total %llu\n"
             "# TYPE voxcast_sent_bytes_total counter\nvoxcast_sent_bytes_total %llu\n",
             (unsigned long long)memory.rss_bytes, totals.client_count, status.ready,
             (unsigned long long)status.revision, (unsigned long long)status.frames_drawn,
             (double)status.draw_us / 1e6, (double)totals.encode_us / 1e6,
             (unsigned long long)totals.frames_sent, (unsigned long long)totals.frames_dropped,
             (unsigned long long)totals.bytes_sent);
    return answer(wsi, HTTP_STATUS_OK, "text/plain; version=0.0.4", body);
}

// The file of a URL below the web client's folder; false if there is none, or if a link or ".."
// leads out of it.
static bool find_file(const struct network *network, const char *url, char *out_path)
{
    char joined[PATH_MAX];
    size_t root_length = strlen(network->web_root);
    if (root_length == 0 || strstr(url, "/.") ||
        snprintf(joined, sizeof(joined), "%s%s%s", network->web_root, url,
                 url[strlen(url) - 1] == '/' ? "index.html" : "") >= (int)sizeof(joined))
        return false;
    return realpath(joined, out_path) && strncmp(out_path, network->web_root, root_length) == 0 &&
           out_path[root_length] == '/' && mime_type(out_path);
}

static int serve(struct network *network, struct lws *wsi, const char *url)
{
    char path[PATH_MAX];
    if (lws_hdr_total_length(wsi, WSI_TOKEN_GET_URI) == 0)
        return answer(wsi, HTTP_STATUS_METHOD_NOT_ALLOWED, "text/plain", "only GET\n");
    if (strcmp(url, "/healthz") == 0)
        return answer(wsi, HTTP_STATUS_OK, "text/plain", "ok\n");
    if (strcmp(url, "/readyz") == 0)
        return answer_ready(network, wsi);
    if (strcmp(url, "/metrics") == 0)
        return answer_metrics(network, wsi);
    const char *headers = security_headers;
    int headers_length = (int)sizeof(security_headers) - 1;
    if (accuracy_service_find_file(network->params.accuracy, url, path, sizeof(path))) {
        headers = measured_headers;
        headers_length = (int)sizeof(measured_headers) - 1;
    } else if (url[0] != '/' || !find_file(network, url, path)) {
        return answer(wsi, HTTP_STATUS_NOT_FOUND, "text/plain", "not found\n");
    }
    int result = lws_serve_http_file(wsi, path, mime_type(path), headers, headers_length);
    // Positive: sent completely. Zero: LWS_CALLBACK_HTTP_FILE_COMPLETION will follow.
    return result == 0 ? 0 : -1;
}

int network_http_callback(struct lws *wsi, enum lws_callback_reasons reason, void *user, void *in,
                          size_t length)
{
    struct network *network = lws_context_user(lws_get_context(wsi));
    (void)user;
    (void)length;
    switch (reason) {
    case LWS_CALLBACK_FILTER_NETWORK_CONNECTION:
        return atomic_load(&network->draining) ? -1 : 0;
    case LWS_CALLBACK_HTTP_CONFIRM_UPGRADE:
        return network_check_upgrade(network, wsi) ? 0 : -1;
    case LWS_CALLBACK_FILTER_PROTOCOL_CONNECTION: // a WebSocket without the subprotocol
        return -1;
    case LWS_CALLBACK_HTTP:
        return serve(network, wsi, in);
    case LWS_CALLBACK_HTTP_FILE_COMPLETION:
        return -1;
    default:
        return 0;
    }
}
