// One WebSocket session: assembles messages, enforces limits, posts commands, sends replies.
#include "server/network/network_internal.h"

#include <stdlib.h>
#include <string.h>

#include "protocol/command.h"
#include "renderer/clock.h"

#define CLOSE_DELAY_US 100000

struct text *text_create(const char *content)
{
    size_t length = strlen(content);
    struct text *text = malloc(sizeof(*text) + LWS_PRE + length);
    if (!text)
        return NULL;
    text->references = 1;
    text->length = length;
    memcpy(text->bytes + LWS_PRE, content, length);
    return text;
}

void text_release(struct text *text)
{
    if (text && --text->references == 0)
        free(text);
}

void session_close(struct session *session, int code, const char *reason)
{
    if (session->close_code)
        return;
    log_write(LOG_INFO, "session_closing client=%u code=%d reason=\"%s\"", session->client_id, code,
              reason);
    session->close_code = code;
    session->close_reason = reason;
    // Incoming data is read and discarded before closing: the library resets a connection that
    // receives more after the close message, and the client would not learn the reason.
    lws_set_timer_usecs(session->wsi, CLOSE_DELAY_US);
    // Ends clients that do not read.
    lws_set_timeout(session->wsi, PENDING_TIMEOUT_CLOSE_SEND, 5);
}

void session_send(struct session *session, struct text *text)
{
    struct text_link *link = text && !session->close_code ? malloc(sizeof(*link)) : NULL;
    if (!link)
        return;
    text->references++;
    *link = (struct text_link){.text = text};
    if (session->last)
        session->last->next = link;
    else
        session->first = link;
    session->last = link;
    session->queued_bytes += text->length;
    if (session->queued_bytes > session->network->params.queue_bytes)
        session_close(session, CLOSE_TOO_SLOW, "too many replies wait to be read");
    lws_callback_on_writable(session->wsi);
}

static void send_owned(struct session *session, char *content)
{
    struct text *text = content ? text_create(content) : NULL;
    session_send(session, text);
    text_release(text);
    free(content);
}

static void send_notice(struct session *session, const struct rpc_error *error,
                        const struct command *command)
{
    cJSON *notice = cJSON_CreateObject();
    cJSON_AddStringToObject(notice, "level", "error");
    cJSON_AddStringToObject(notice, "message", error->message);
    if (command) {
        cJSON_AddStringToObject(notice, "method", method_name(command->method));
        if (command->has_edit_id)
            cJSON_AddNumberToObject(notice, "edit_id", (double)command->edit_id);
    }
    send_owned(session, rpc_write_notification("session.notice", notice));
}

static void send_error(struct session *session, const struct rpc_id *id,
                       const struct rpc_error *error, const struct command *command)
{
    if (id->json[0])
        send_owned(session, rpc_write_error(id, error));
    else
        send_notice(session, error, command);
}

static void send_superseded(struct session *session, const struct rpc_id *id,
                            const uint64_t *edit_id)
{
    if (!id->json[0])
        return;
    cJSON *result = cJSON_CreateObject();
    if (edit_id)
        cJSON_AddNumberToObject(result, "superseded_by", (double)*edit_id);
    else
        cJSON_AddNullToObject(result, "superseded_by");
    send_owned(session, rpc_write_result(id, result));
}

// Token bucket: `message_rate` a second, twice that at once.
static bool rate_allows(struct session *session)
{
    double rate = session->network->params.message_rate;
    uint64_t now = clock_now_us();
    session->tokens += (double)(now - session->tokens_at_us) / 1e6 * rate;
    session->tokens_at_us = now;
    if (session->tokens >= 2.0 * rate) {
        session->tokens = 2.0 * rate;
        session->rate_errors = 0;
    }
    if (session->tokens < 1.0)
        return false;
    session->tokens -= 1.0;
    return true;
}

static void refuse_by_rate(struct session *session)
{
    struct rpc_error error;
    struct rpc_id nobody = {"null"};
    rpc_error_set(&error, RPC_RATE_LIMIT, "more than %u messages a second",
                  session->network->params.message_rate);
    send_error(session, &nobody, &error, NULL);
    if (++session->rate_errors >= SESSION_MAX_RATE_ERRORS)
        session_close(session, CLOSE_TOO_MANY, "too many messages");
}

// Decides whether the session may run the command; fixes its role at session.hello.
static bool check_permission(struct session *session, const struct command *command,
                             struct rpc_error *error)
{
    const struct network_params *params = &session->network->params;
    if (command->method == METHOD_SESSION_HELLO) {
        if (command->token[0] && (params->token[0] || params->viewer_token[0]))
            session->role = network_check_token(session->network, command->token);
        if (session->role == ROLE_NONE)
            return rpc_error_set(error, RPC_NOT_PERMITTED, "the token is wrong or missing");
        session->said_hello = true;
        return true;
    }
    if (!session->said_hello)
        return rpc_error_set(error, RPC_HELLO_FIRST, "session.hello must come first");
    if (method_get_flags(command->method) & METHOD_EDITS && session->role != ROLE_EDITOR)
        return rpc_error_set(error, RPC_NOT_PERMITTED, "a viewer may not edit");
    return true;
}

// Takes over `command`.
static void post(struct session *session, struct command *command)
{
    struct rpc_id superseded;
    // Once posted, the command belongs to the render thread.
    bool has_edit_id = command->has_edit_id;
    uint64_t edit_id = command->edit_id;
    switch (mailbox_post(session->network->params.mailbox, command, &superseded)) {
    case MAILBOX_POSTED:
        break;
    case MAILBOX_SUPERSEDED:
        send_superseded(session, &superseded, has_edit_id ? &edit_id : NULL);
        break;
    case MAILBOX_FULL: {
        struct rpc_error error;
        rpc_error_set(&error, RPC_BUSY, "too many commands wait; send this one again later");
        send_error(session, &command->id, &error, command);
        free(command);
        break;
    }
    }
}

static void handle_request(struct session *session, const struct rpc_request *request)
{
    struct rpc_error error;
    struct command *command = malloc(sizeof(*command));
    if (!command)
        return;
    if (!command_parse(request, command, &error) || !check_permission(session, command, &error)) {
        bool known = error.code != RPC_METHOD_NOT_FOUND;
        send_error(session, &request->id, &error, known ? command : NULL);
        if (session->role == ROLE_NONE && known && command->method == METHOD_SESSION_HELLO)
            session_close(session, CLOSE_WRONG_TOKEN, "the token is wrong or missing");
        free(command);
        return;
    }
    if (command->method == METHOD_FRAME_ACK) {
        frame_stream_acknowledge(session->network->params.stream, session->slot, command->revision);
        if (command->id.json[0])
            send_owned(session, rpc_write_result(&command->id, cJSON_CreateObject()));
        free(command);
        return;
    }
    command->client_id = session->client_id;
    command->viewer = session->role == ROLE_VIEWER;
    post(session, command);
}

static void handle_message(struct session *session, const char *message, size_t length)
{
    struct rpc_request request;
    struct rpc_error error;
    if (!rate_allows(session)) {
        refuse_by_rate(session);
    } else if (!rpc_request_parse(message, length, &request, &error)) {
        send_error(session, &request.id, &error, NULL);
    } else {
        handle_request(session, &request);
        rpc_request_finish(&request);
    }
}

// Appends a fragment; handles the message when it is complete.
static void receive(struct session *session, const void *bytes, size_t length)
{
    if (session->close_code)
        return;
    if (lws_frame_is_binary(session->wsi)) {
        session_close(session, CLOSE_NOT_TEXT, "clients send text");
        return;
    }
    if (session->message_length + length > session->network->params.message_bytes) {
        session_close(session, CLOSE_TOO_LARGE, "the message is too large");
        return;
    }
    char *message = realloc(session->message, session->message_length + length + 1);
    if (!message) {
        session_close(session, CLOSE_TOO_LARGE, "out of memory for the message");
        return;
    }
    memcpy(message + session->message_length, bytes, length);
    session->message = message;
    session->message_length += length;
    if (!lws_is_final_fragment(session->wsi) || lws_remaining_packet_payload(session->wsi) > 0)
        return;
    handle_message(session, session->message, session->message_length);
    free(session->message);
    session->message = NULL;
    session->message_length = 0;
}

static int open_session(struct session *session, struct lws *wsi)
{
    struct network *network = lws_context_user(lws_get_context(wsi));
    memset(session, 0, sizeof(*session));
    char token[PROTOCOL_MAX_TOKEN_BYTES + 1];
    bool open = !network->params.token[0] && !network->params.viewer_token[0];
    session->role = open ? ROLE_EDITOR : ROLE_NONE;
    if (!open && network_get_query(wsi, "token", token, sizeof(token)))
        session->role = network_check_token(network, token);
    if (!frame_stream_open(network->params.stream, &session->slot, &session->client_id))
        return -1;
    session->network = network;
    session->wsi = wsi;
    session->tokens = 2.0 * network->params.message_rate;
    session->tokens_at_us = clock_now_us();
    session->next = network->sessions;
    network->sessions = session;
    lws_set_timer_usecs(wsi, (lws_usec_t)SESSION_HELLO_SECONDS * LWS_US_PER_SEC);
    log_write(LOG_INFO, "session_opened client=%u", session->client_id);
    return 0;
}

static void drop_first(struct session *session)
{
    struct text_link *link = session->first;
    session->first = link->next;
    if (!session->first)
        session->last = NULL;
    session->queued_bytes -= link->text->length;
    text_release(link->text);
    free(link);
}

static void finish_session(struct session *session)
{
    if (!session->network) // was never opened
        return;
    for (struct session **at = &session->network->sessions; *at; at = &(*at)->next) {
        if (*at == session) {
            *at = session->next;
            break;
        }
    }
    while (session->first)
        drop_first(session);
    free(session->message);
    frame_stream_close(session->network->params.stream, session->slot);
    log_write(LOG_INFO, "session_closed client=%u", session->client_id);
    session->network = NULL;
}

// Sends one message. Texts go first: they are small and carry the replies.
static int write_next(struct session *session)
{
    struct frame_stream *stream = session->network->params.stream;
    if (session->first) {
        struct text *text = session->first->text;
        int written = lws_write(session->wsi, text->bytes + LWS_PRE, text->length, LWS_WRITE_TEXT);
        drop_first(session);
        if (written < 0)
            return -1;
    } else if (session->close_due) {
        lws_close_reason(session->wsi, (enum lws_close_status)session->close_code,
                         (unsigned char *)session->close_reason, strlen(session->close_reason));
        return -1;
    } else if (!session->close_code) {
        struct encoded_frame *frame = frame_stream_take(stream, session->slot);
        int written = frame ? lws_write(session->wsi, frame->bytes + FRAME_STREAM_PREFIX_BYTES,
                                        frame->message_bytes, LWS_WRITE_BINARY)
                            : 0;
        free(frame);
        if (written < 0)
            return -1;
    }
    if (session->first || session->close_due || frame_stream_has_frame(stream, session->slot))
        lws_callback_on_writable(session->wsi);
    return 0;
}

static void take_timer(struct session *session)
{
    if (session->close_code) {
        session->close_due = true;
        lws_callback_on_writable(session->wsi);
    } else if (!session->said_hello) {
        session_close(session, CLOSE_NO_HELLO, "session.hello did not come");
    }
}

int network_session_callback(struct lws *wsi, enum lws_callback_reasons reason, void *user,
                             void *in, size_t length)
{
    struct session *session = user;
    switch (reason) {
    case LWS_CALLBACK_ESTABLISHED:
        return open_session(session, wsi);
    case LWS_CALLBACK_RECEIVE:
        receive(session, in, length);
        return 0;
    case LWS_CALLBACK_SERVER_WRITEABLE:
        return write_next(session);
    case LWS_CALLBACK_TIMER:
        take_timer(session);
        return 0;
    case LWS_CALLBACK_CLOSED:
        finish_session(session);
        return 0;
    default:
        return 0;
    }
}
