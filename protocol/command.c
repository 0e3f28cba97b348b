#include "protocol/command.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include <cjson/cJSON.h>

enum field_kind { FIELD_INTEGER, FIELD_NUMBER, FIELD_BOOL, FIELD_STRING, FIELD_CHOICE };

enum field_bit {
    TARGET = 1 << 0,
    IMAGE = 1 << 1,
    EDIT_ID = 1 << 2,
    TRANSIENT = 1 << 3,
    REVISION = 1 << 4,
    FRAME_ID = 1 << 5,
    PROTOCOL = 1 << 6,
    NAME = 1 << 7,
    TOKEN = 1 << 8,
    RESUME_EPOCH = 1 << 9,
    RESUME_REVISION = 1 << 10,
    SOURCE = 1 << 11,
    PIXEL_X = 1 << 12,
    PIXEL_Y = 1 << 13,
    SET = 1 << 14,  // an object of parameters
    FLAT = 1 << 15, // parameters beside the fields
    SWEEP = 1 << 16,
    NOISE = 1 << 17,
    SECONDS = 1 << 18,
    FILE_NAME = 1 << 19,
};

struct field {
    const char *name;
    uint32_t bit;
    enum field_kind kind;
    double min, max;            // of a number; max bytes of a string
    const char *const *choices; // ended by NULL
};

const char *const command_sweep_names[SWEEP_COUNT + 1] = {
    [SWEEP_QUICK] = "quick", [SWEEP_FULL] = "full"};

static const struct field fields[] = {
    {"id", TARGET, FIELD_INTEGER, 0, UINT32_MAX - 1.0},
    {"image", IMAGE, FIELD_INTEGER, 0, UINT32_MAX - 1.0},
    {"edit_id", EDIT_ID, FIELD_INTEGER, 0, PROTOCOL_MAX_SAFE_INTEGER},
    {"transient", TRANSIENT, FIELD_BOOL, 0, 0},
    {"revision", REVISION, FIELD_INTEGER, 0, PROTOCOL_MAX_SAFE_INTEGER},
    {"frame_id", FRAME_ID, FIELD_INTEGER, 0, PROTOCOL_MAX_SAFE_INTEGER},
    {"protocol", PROTOCOL, FIELD_INTEGER, PROTOCOL_VERSION, PROTOCOL_VERSION},
    {"name", NAME, FIELD_STRING, 0, PROTOCOL_MAX_NAME_BYTES},
    {"token", TOKEN, FIELD_STRING, 0, PROTOCOL_MAX_TOKEN_BYTES},
    {"resume_epoch", RESUME_EPOCH, FIELD_INTEGER, 0, PROTOCOL_MAX_SAFE_INTEGER},
    {"resume_revision", RESUME_REVISION, FIELD_INTEGER, 0, PROTOCOL_MAX_SAFE_INTEGER},
    {"source", SOURCE, FIELD_STRING, 0, PROTOCOL_MAX_SOURCE_BYTES},
    {"name", FILE_NAME, FIELD_STRING, 0, PROTOCOL_MAX_SOURCE_BYTES},
    {"x", PIXEL_X, FIELD_NUMBER, 0, 4096},
    {"y", PIXEL_Y, FIELD_NUMBER, 0, 2160},
    {"ladder", SWEEP, FIELD_CHOICE, 0, 0, command_sweep_names},
    {"noise", NOISE, FIELD_NUMBER, 0.0005, 0.1},
    {"seconds", SECONDS, FIELD_NUMBER, 1, 86400},
};

struct method_row {
    const char *name;
    uint32_t flags;
    enum parameter_group group;
    uint32_t allowed;  // field bits
    uint32_t required; // field bits
};

#define EDIT   (EDIT_ID | TRANSIENT)
#define MERGES (METHOD_EDITS | METHOD_MERGES)

#define METHOD(constant, ...) [METHOD_##constant] = {__VA_ARGS__},
static const struct method_row methods[METHOD_COUNT] = {
#include "protocol/methods.def"
};
#undef METHOD

const char *method_name(enum method method)
{
    return methods[method].name;
}

uint32_t method_get_flags(enum method method)
{
    return methods[method].flags;
}

enum parameter_group method_get_group(enum method method)
{
    return methods[method].group;
}

static bool check_number(const struct field *field, const cJSON *item, struct rpc_error *error)
{
    const char *wanted = field->kind == FIELD_INTEGER ? "a whole number" : "a number";
    bool number = cJSON_IsNumber(item);
    if (!number || (field->kind == FIELD_INTEGER && item->valuedouble != floor(item->valuedouble)))
        return rpc_error_field(error, field->name, item, "%s must be %s", field->name, wanted);
    if (item->valuedouble >= field->min && item->valuedouble <= field->max)
        return true;
    rpc_error_field(error, field->name, item, "%s: %g is out of range; allowed are %g to %g",
                    field->name, item->valuedouble, field->min, field->max);
    error->has_range = true;
    error->min = field->min;
    error->max = field->max;
    return false;
}

// The index of a text in a list that NULL ends, or the list's length.
static uint32_t find_choice(const char *const *choices, const cJSON *item)
{
    uint32_t i = 0;
    while (choices[i] && !(cJSON_IsString(item) && strcmp(choices[i], item->valuestring) == 0))
        i++;
    return i;
}

static bool check_choice(const struct field *field, const cJSON *item, struct rpc_error *error)
{
    if (field->choices[find_choice(field->choices, item)])
        return true;
    char list[256] = "";
    for (size_t i = 0, used = 0; field->choices[i] && used < sizeof(list); i++)
        used += (size_t)snprintf(list + used, sizeof(list) - used, "%s%s", i ? ", " : "",
                                 field->choices[i]);
    rpc_error_field(error, field->name, item, "%s is not one of %s", field->name, list);
    error->allowed = field->choices;
    return false;
}

static bool check_field(const struct field *field, const cJSON *item, struct rpc_error *error)
{
    if (field->kind == FIELD_BOOL)
        return cJSON_IsBool(item) ||
               rpc_error_field(error, field->name, item, "%s must be true or false", field->name);
    if (field->kind == FIELD_CHOICE)
        return check_choice(field, item, error);
    if (field->kind != FIELD_STRING)
        return check_number(field, item, error);
    if (!cJSON_IsString(item))
        return rpc_error_field(error, field->name, item, "%s must be a string", field->name);
    if (strlen(item->valuestring) > (size_t)field->max)
        return rpc_error_field(error, field->name, item, "%s: %zu bytes; allowed are %g",
                               field->name, strlen(item->valuestring), field->max);
    for (const char *c = item->valuestring; *c; c++) {
        if ((unsigned char)*c < 0x20 || *c == 0x7f)
            return rpc_error_field(error, field->name, item, "%s must not hold control characters",
                                   field->name);
    }
    return true;
}

static void store_field(const struct field *field, const cJSON *item, struct command *command)
{
    double number = cJSON_IsNumber(item) ? item->valuedouble : 0.0;
    switch ((enum field_bit)field->bit) {
    case TARGET:
    case IMAGE:
        command->target = (uint32_t)number;
        break;
    case EDIT_ID:
        command->has_edit_id = true;
        command->edit_id = (uint64_t)number;
        break;
    case TRANSIENT:
        command->transient = cJSON_IsTrue(item);
        break;
    case REVISION:
    case FRAME_ID:
        command->has_revision = true;
        command->revision = (uint64_t)number;
        break;
    case NAME:
        strcpy(command->name, item->valuestring);
        break;
    case TOKEN:
        strcpy(command->token, item->valuestring);
        break;
    case RESUME_EPOCH:
        command->resume_epoch = (uint64_t)number;
        break;
    case RESUME_REVISION:
        command->resume_revision = (uint64_t)number;
        break;
    case SOURCE:
    case FILE_NAME:
        strcpy(command->source, item->valuestring);
        break;
    case PIXEL_X:
        command->x = number;
        break;
    case PIXEL_Y:
        command->y = number;
        break;
    case SWEEP:
        command->sweep = (enum command_sweep)find_choice(field->choices, item);
        break;
    case NOISE:
        command->noise = number;
        break;
    case SECONDS:
        command->seconds = number;
        break;
    case PROTOCOL:
    case SET:
    case FLAT:
        break;
    }
}

static bool add_value(struct command *command, enum parameter_group group, const cJSON *item,
                      struct rpc_error *error)
{
    const struct parameter *parameter = parameter_find(group, item->string);
    if (!parameter)
        return rpc_error_field(error, item->string, item, "%s has no parameter \"%.60s\"",
                               methods[command->method].name, item->string);
    // Keys are unique, so there are at most as many as the table has in the group.
    if (command->value_count == COMMAND_MAX_VALUES)
        return rpc_error_field(error, item->string, item, "more than %u fields",
                               COMMAND_MAX_VALUES);
    if (!parameter_value_from_json(parameter, item, &command->values[command->value_count], error))
        return false;
    command->value_count++;
    return true;
}

static bool add_set(struct command *command, enum parameter_group group, const cJSON *set,
                    struct rpc_error *error)
{
    if (!cJSON_IsObject(set))
        return rpc_error_field(error, "set", set, "set must be an object");
    for (const cJSON *item = set->child; item; item = item->next) {
        if (!add_value(command, group, item, error))
            return false;
    }
    if (command->value_count == 0 && command->method != METHOD_LIGHT_ADD)
        return rpc_error_field(error, "set", set, "set must name a field to change");
    return true;
}

static const struct field *find_field(uint32_t allowed, const char *name)
{
    for (size_t i = 0; i < sizeof(fields) / sizeof(fields[0]); i++) {
        if (fields[i].bit & allowed && strcmp(fields[i].name, name) == 0)
            return &fields[i];
    }
    return NULL;
}

static bool add_param(struct command *command, const struct method_row *row, const cJSON *item,
                      uint32_t *seen, struct rpc_error *error)
{
    if (row->allowed & SET && strcmp(item->string, "set") == 0) {
        *seen |= SET;
        return add_set(command, row->group, item, error);
    }
    const struct field *field = find_field(row->allowed, item->string);
    if (field) {
        *seen |= field->bit;
        if (!check_field(field, item, error))
            return false;
        store_field(field, item, command);
        return true;
    }
    if (row->allowed & FLAT)
        return add_value(command, row->group, item, error);
    return rpc_error_field(error, item->string, item, "%s has no parameter \"%.60s\"", row->name,
                           item->string);
}

static bool check_required(const struct method_row *row, uint32_t seen, struct rpc_error *error)
{
    uint32_t missing = row->required & ~seen;
    if (missing & SET)
        return rpc_error_field(error, "set", NULL, "%s: set is missing", row->name);
    for (size_t i = 0; i < sizeof(fields) / sizeof(fields[0]); i++) {
        if (fields[i].bit & missing)
            return rpc_error_field(error, fields[i].name, NULL, "%s: %s is missing", row->name,
                                   fields[i].name);
    }
    return true;
}

bool command_parse(const struct rpc_request *request, struct command *out_command,
                   struct rpc_error *out_error)
{
    memset(out_command, 0, sizeof(*out_command));
    out_command->id = request->id;
    out_command->target = COMMAND_NO_TARGET;
    out_command->noise = COMMAND_DEFAULT_NOISE;
    out_command->seconds = COMMAND_DEFAULT_SECONDS;
    uint32_t method = 0;
    while (method < METHOD_COUNT && strcmp(methods[method].name, request->method) != 0)
        method++;
    if (method == METHOD_COUNT)
        return rpc_error_set(out_error, RPC_METHOD_NOT_FOUND, "no method \"%.60s\"",
                             request->method);
    const struct method_row *row = &methods[method];
    out_command->method = (enum method)method;
    uint32_t seen = 0;
    for (const cJSON *item = request->params ? request->params->child : NULL; item;
         item = item->next) {
        if (!add_param(out_command, row, item, &seen, out_error))
            return false;
    }
    out_command->has_resume = (seen & RESUME_EPOCH) && (seen & RESUME_REVISION);
    return check_required(row, seen, out_error);
}

static bool has_parameter(const struct command *command, const struct parameter *parameter)
{
    for (uint32_t i = 0; i < command->value_count; i++) {
        if (command->values[i].parameter == parameter)
            return true;
    }
    return false;
}

bool command_supersedes(const struct command *newer, const struct command *older)
{
    if (!(methods[newer->method].flags & METHOD_MERGES) || newer->method != older->method ||
        newer->client_id != older->client_id || newer->target != older->target ||
        newer->value_count != older->value_count)
        return false;
    for (uint32_t i = 0; i < newer->value_count; i++) {
        if (!has_parameter(older, newer->values[i].parameter))
            return false;
    }
    return true;
}
