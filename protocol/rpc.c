#include "protocol/rpc.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cjson/cJSON.h>

#include "protocol/json_scan.h"
#include "protocol/utf8.h"

bool rpc_error_set(struct rpc_error *error, int code, const char *format, ...)
{
    memset(error, 0, sizeof(*error));
    error->code = code;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(error->message, sizeof(error->message), format, arguments);
    va_end(arguments);
    return false;
}

bool rpc_error_field(struct rpc_error *error, const char *field, const cJSON *value,
                     const char *format, ...)
{
    memset(error, 0, sizeof(*error));
    error->code = RPC_INVALID_PARAMS;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(error->message, sizeof(error->message), format, arguments);
    va_end(arguments);
    snprintf(error->field, sizeof(error->field), "%s", field);
    char *json = value ? cJSON_PrintUnformatted(value) : NULL;
    if (json)
        snprintf(error->value, sizeof(error->value), "%s", json);
    free(json);
    return false;
}

// True unless an object at any depth holds a key twice. Recursion is bounded by the depth that
// json_scan() allows.
static bool keys_are_unique(const cJSON *item)
{
    for (const cJSON *child = item->child; child; child = child->next) {
        if (cJSON_IsObject(item)) {
            for (const cJSON *other = child->next; other; other = other->next) {
                if (strcmp(child->string, other->string) == 0)
                    return false;
            }
        }
        if (!keys_are_unique(child))
            return false;
    }
    return true;
}

static bool read_id(const cJSON *item, struct rpc_id *out_id)
{
    bool number = cJSON_IsNumber(item) && fabs(item->valuedouble) <= PROTOCOL_MAX_SAFE_INTEGER;
    if (!number && !cJSON_IsString(item))
        return false;
    char *json = cJSON_PrintUnformatted(item);
    bool fits = json && strlen(json) < sizeof(out_id->json);
    if (fits)
        strcpy(out_id->json, json);
    free(json);
    return fits;
}

static bool check_request(const cJSON *root, struct rpc_request *request, struct rpc_error *error)
{
    if (cJSON_IsArray(root))
        return rpc_error_set(error, RPC_INVALID_REQUEST,
                             "batches are not supported; send one request in a message");
    if (!cJSON_IsObject(root))
        return rpc_error_set(error, RPC_INVALID_REQUEST, "a request is an object");
    if (!keys_are_unique(root))
        return rpc_error_set(error, RPC_INVALID_REQUEST, "an object holds a key twice");
    const cJSON *id = cJSON_GetObjectItemCaseSensitive(root, "id");
    if (id && !read_id(id, &request->id))
        return rpc_error_set(error, RPC_INVALID_REQUEST,
                             "id must be a number or a string of at most %u bytes",
                             PROTOCOL_MAX_ID_BYTES);
    if (!id)
        request->id.json[0] = '\0';
    const cJSON *version = cJSON_GetObjectItemCaseSensitive(root, "jsonrpc");
    if (!cJSON_IsString(version) || strcmp(version->valuestring, "2.0") != 0)
        return rpc_error_set(error, RPC_INVALID_REQUEST, "jsonrpc must be \"2.0\"");
    const cJSON *method = cJSON_GetObjectItemCaseSensitive(root, "method");
    if (!cJSON_IsString(method))
        return rpc_error_set(error, RPC_INVALID_REQUEST, "method must be a string");
    request->method = method->valuestring;
    request->params = cJSON_GetObjectItemCaseSensitive(root, "params");
    if (request->params && !cJSON_IsObject(request->params))
        return rpc_error_set(error, RPC_INVALID_PARAMS, "params must be an object");
    for (const cJSON *child = root->child; child; child = child->next) {
        if (strcmp(child->string, "jsonrpc") && strcmp(child->string, "id") &&
            strcmp(child->string, "method") && strcmp(child->string, "params"))
            return rpc_error_set(error, RPC_INVALID_REQUEST, "unknown member \"%.60s\"",
                                 child->string);
    }
    return true;
}

bool rpc_request_parse(const char *text, size_t length, struct rpc_request *out_request,
                       struct rpc_error *out_error)
{
    *out_request = (struct rpc_request){.id = {"null"}};
    char message[256];
    if (!json_scan(text, length, message, sizeof(message)))
        return rpc_error_set(out_error, RPC_PARSE_ERROR, "%s", message);
    cJSON *root = cJSON_ParseWithLength(text, length);
    if (!root)
        return rpc_error_set(out_error, RPC_PARSE_ERROR, "not JSON, or out of memory");
    if (!check_request(root, out_request, out_error)) {
        cJSON_Delete(root);
        out_request->method = NULL;
        out_request->params = NULL;
        return false;
    }
    out_request->root = root;
    return true;
}

void rpc_request_finish(struct rpc_request *request)
{
    cJSON_Delete(request->root);
    request->root = NULL;
    request->method = NULL;
    request->params = NULL;
}

static char *print_and_delete(cJSON *message)
{
    char *text = cJSON_PrintUnformatted(message);
    cJSON_Delete(message);
    // Names from files, and texts cut to fit a buffer, may be invalid UTF-8, on which a browser
    // would close the connection.
    if (text)
        utf8_repair(text);
    return text;
}

static cJSON *create_reply(const struct rpc_id *id)
{
    cJSON *reply = cJSON_CreateObject();
    cJSON_AddStringToObject(reply, "jsonrpc", "2.0");
    cJSON_AddRawToObject(reply, "id", id->json[0] ? id->json : "null");
    return reply;
}

char *rpc_write_result(const struct rpc_id *id, cJSON *result)
{
    cJSON *reply = create_reply(id);
    cJSON_AddItemToObject(reply, "result", result);
    return print_and_delete(reply);
}

static cJSON *error_data(const struct rpc_error *error)
{
    cJSON *data = cJSON_CreateObject();
    cJSON_AddStringToObject(data, "field", error->field);
    if (error->value[0])
        cJSON_AddStringToObject(data, "value", error->value);
    if (error->has_range) {
        cJSON_AddNumberToObject(data, "min", error->min);
        cJSON_AddNumberToObject(data, "max", error->max);
    }
    if (error->allowed) {
        cJSON *allowed = cJSON_AddArrayToObject(data, "allowed");
        for (const char *const *name = error->allowed; *name; name++)
            cJSON_AddItemToArray(allowed, cJSON_CreateString(*name));
    }
    return data;
}

char *rpc_write_error(const struct rpc_id *id, const struct rpc_error *error)
{
    cJSON *reply = create_reply(id);
    cJSON *object = cJSON_AddObjectToObject(reply, "error");
    cJSON_AddNumberToObject(object, "code", error->code);
    cJSON_AddStringToObject(object, "message", error->message);
    if (error->field[0])
        cJSON_AddItemToObject(object, "data", error_data(error));
    return print_and_delete(reply);
}

char *rpc_write_notification(const char *method, cJSON *params)
{
    cJSON *message = cJSON_CreateObject();
    cJSON_AddStringToObject(message, "jsonrpc", "2.0");
    cJSON_AddStringToObject(message, "method", method);
    cJSON_AddItemToObject(message, "params", params);
    return print_and_delete(message);
}
