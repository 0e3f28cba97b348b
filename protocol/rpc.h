// JSON-RPC 2.0: parses requests and writes replies, errors and notifications. Pure.
#ifndef VOXCAST_PROTOCOL_RPC_H
#define VOXCAST_PROTOCOL_RPC_H

#include <stdbool.h>
#include <stddef.h>

#include "protocol/limits.h"
#include "protocol/parameters.h"

enum rpc_error_code {
    RPC_PARSE_ERROR = -32700,
    RPC_INVALID_REQUEST = -32600,
    RPC_METHOD_NOT_FOUND = -32601,
    RPC_INVALID_PARAMS = -32602,
    RPC_INTERNAL_ERROR = -32603,
    RPC_HELLO_FIRST = -32000,
    RPC_NOT_PERMITTED = -32001,
    RPC_BUSY = -32002,
    RPC_RATE_LIMIT = -32003,
    RPC_LOAD_FAILED = -32004,
    RPC_NOT_READY = -32005,
};

struct rpc_error {
    int code; // enum rpc_error_code; 0 for none
    char message[512];
    char field[64]; // "" when no field is at fault
    char value[64]; // JSON as sent, cut
    bool has_range; // min and max are valid
    double min, max;
    const char *const *allowed; // ended by NULL; NULL for none
};

// Fills code and message, clears the rest, returns false.
bool rpc_error_set(struct rpc_error *error, int code, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

// RPC_INVALID_PARAMS about a field; `value` may be NULL. Returns false.
bool rpc_error_field(struct rpc_error *error, const char *field, const struct cJSON *value,
                     const char *format, ...) __attribute__((format(printf, 4, 5)));

// A JSON-RPC id as JSON text; "" for a notification.
struct rpc_id {
    char json[PROTOCOL_MAX_ID_BYTES + 3];
};

struct rpc_request {
    struct rpc_id id;
    const char *method;         // within `root`
    const struct cJSON *params; // an object within `root`, or NULL
    struct cJSON *root;         // owned; free with rpc_request_finish()
};

// Scans, parses and checks one message. On failure the request needs no finish, `out_error` holds
// the reason, and `out_request->id` holds the id if it could be read, else "null".
bool rpc_request_parse(const char *text, size_t length, struct rpc_request *out_request,
                       struct rpc_error *out_error);
void rpc_request_finish(struct rpc_request *request);

// Each takes over `result` or `params` and returns text from malloc, which the caller frees with
// free(), or NULL when out of memory.
char *rpc_write_result(const struct rpc_id *id, struct cJSON *result);
char *rpc_write_error(const struct rpc_id *id, const struct rpc_error *error);
char *rpc_write_notification(const char *method, struct cJSON *params);

#endif
