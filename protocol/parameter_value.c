#include "protocol/parameter_value.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cjson/cJSON.h>

static bool fail_range(const struct parameter *parameter, const cJSON *item, double number,
                       struct rpc_error *error)
{
    rpc_error_field(error, parameter->name, item, "%s: %g is out of range; allowed are %g to %g",
                    parameter->name, number, parameter->min, parameter->max);
    error->has_range = true;
    error->min = parameter->min;
    error->max = parameter->max;
    return false;
}

static bool fail_enum(const struct parameter *parameter, const cJSON *item, struct rpc_error *error)
{
    char *json = cJSON_PrintUnformatted(item);
    char list[384] = "";
    for (size_t i = 0, used = 0; parameter->values[i] && used < sizeof(list); i++)
        used += (size_t)snprintf(list + used, sizeof(list) - used, "%s%s", i ? ", " : "",
                                 parameter->values[i]);
    rpc_error_field(error, parameter->name, item, "%s: %.60s is not one of %s", parameter->name,
                    json ? json : "", list);
    error->allowed = parameter->values;
    free(json);
    return false;
}

static bool fail_type(const struct parameter *parameter, const cJSON *item, const char *wanted,
                      struct rpc_error *error)
{
    char *json = cJSON_PrintUnformatted(item);
    rpc_error_field(error, parameter->name, item, "%s: %.60s is not %s", parameter->name,
                    json ? json : "", wanted);
    free(json);
    return false;
}

static bool read_component(const struct parameter *parameter, const cJSON *item,
                           const cJSON *component, double *out, struct rpc_error *error)
{
    if (!cJSON_IsNumber(component))
        return fail_type(parameter, item, "made of numbers", error);
    double number = component->valuedouble;
    if (!isfinite(number) || number < parameter->min || number > parameter->max)
        return fail_range(parameter, item, number, error);
    if (parameter->type == PARAMETER_INT && number != floor(number))
        return fail_type(parameter, item, "a whole number", error);
    *out = number;
    return true;
}

static bool read_vector(const struct parameter *parameter, const cJSON *item,
                        struct parameter_value *value, struct rpc_error *error)
{
    int count = (int)parameter_component_count(parameter->type);
    if (!cJSON_IsArray(item) || cJSON_GetArraySize(item) != count)
        return fail_type(parameter, item,
                         count == 3 ? "an array of 3 numbers" : "an array of 4 numbers", error);
    double length_squared = 0.0;
    int i = 0;
    for (const cJSON *component = item->child; component; component = component->next, i++) {
        if (!read_component(parameter, item, component, &value->numbers[i], error))
            return false;
        length_squared += value->numbers[i] * value->numbers[i];
    }
    if (parameter->flags & PARAMETER_NONZERO && length_squared < 1e-12)
        return fail_type(parameter, item, "longer than 0", error);
    return true;
}

static bool read_string(const struct parameter *parameter, const cJSON *item,
                        struct parameter_value *value, struct rpc_error *error)
{
    if (!cJSON_IsString(item))
        return fail_type(parameter, item, "a string", error);
    size_t length = strlen(item->valuestring);
    if (length > PROTOCOL_MAX_NAME_BYTES)
        return rpc_error_field(error, parameter->name, item, "%s: %zu bytes; allowed are %u",
                               parameter->name, length, PROTOCOL_MAX_NAME_BYTES);
    for (const char *c = item->valuestring; *c; c++) {
        if ((unsigned char)*c < 0x20 || *c == 0x7f)
            return fail_type(parameter, item, "free of control characters", error);
    }
    memcpy(value->text, item->valuestring, length + 1);
    return true;
}

static bool read_enum(const struct parameter *parameter, const cJSON *item,
                      struct parameter_value *value, struct rpc_error *error)
{
    for (uint32_t i = 0; cJSON_IsString(item) && parameter->values[i]; i++) {
        if (strcmp(parameter->values[i], item->valuestring) == 0) {
            value->numbers[0] = i;
            return true;
        }
    }
    return fail_enum(parameter, item, error);
}

bool parameter_value_from_json(const struct parameter *parameter, const cJSON *item,
                               struct parameter_value *out_value, struct rpc_error *out_error)
{
    struct parameter_value value = {.parameter = parameter};
    bool fine = false;
    switch (parameter->type) {
    case PARAMETER_FLOAT:
    case PARAMETER_INT:
        fine = cJSON_IsNumber(item)
                   ? read_component(parameter, item, item, value.numbers, out_error)
                   : fail_type(parameter, item, "a number", out_error);
        break;
    case PARAMETER_BOOL:
        fine = cJSON_IsBool(item) || fail_type(parameter, item, "true or false", out_error);
        value.numbers[0] = cJSON_IsTrue(item);
        break;
    case PARAMETER_ENUM:
        fine = read_enum(parameter, item, &value, out_error);
        break;
    case PARAMETER_STRING:
        fine = read_string(parameter, item, &value, out_error);
        break;
    default:
        fine = read_vector(parameter, item, &value, out_error);
        break;
    }
    if (fine)
        *out_value = value;
    return fine;
}

// Turns `0,1,0` into an array of numbers; NULL if it is not one.
static cJSON *array_from_text(const char *text)
{
    cJSON *array = cJSON_CreateArray();
    for (;;) {
        char *end = NULL;
        double number = strtod(text, &end);
        if (end == text || (*end != ',' && *end != '\0') || cJSON_GetArraySize(array) == 4) {
            cJSON_Delete(array);
            return NULL;
        }
        cJSON_AddItemToArray(array, cJSON_CreateNumber(number));
        if (*end == '\0')
            return array;
        text = end + 1;
    }
}

static cJSON *item_from_text(const struct parameter *parameter, const char *text)
{
    char *end = NULL;
    switch (parameter->type) {
    case PARAMETER_FLOAT:
    case PARAMETER_INT: {
        double number = strtod(text, &end);
        return end != text && *end == '\0' ? cJSON_CreateNumber(number) : NULL;
    }
    case PARAMETER_BOOL:
        if (strcmp(text, "true") == 0 || strcmp(text, "1") == 0)
            return cJSON_CreateTrue();
        return strcmp(text, "false") == 0 || strcmp(text, "0") == 0 ? cJSON_CreateFalse() : NULL;
    case PARAMETER_ENUM:
    case PARAMETER_STRING:
        return cJSON_CreateString(text);
    default:
        return array_from_text(text);
    }
}

bool parameter_value_from_text(const struct parameter *parameter, const char *text,
                               struct parameter_value *out_value, struct rpc_error *out_error)
{
    cJSON *item = item_from_text(parameter, text);
    // Text that cannot be read as the type is passed on as a string, which is then refused.
    if (!item)
        item = cJSON_CreateString(text);
    bool fine = parameter_value_from_json(parameter, item, out_value, out_error);
    cJSON_Delete(item);
    return fine;
}

cJSON *parameter_value_to_json(const struct parameter_value *value)
{
    const struct parameter *parameter = value->parameter;
    switch (parameter->type) {
    case PARAMETER_FLOAT:
    case PARAMETER_INT:
        return cJSON_CreateNumber(value->numbers[0]);
    case PARAMETER_BOOL:
        return cJSON_CreateBool(value->numbers[0] != 0.0);
    case PARAMETER_ENUM:
        return cJSON_CreateString(parameter->values[(size_t)value->numbers[0]]);
    case PARAMETER_STRING:
        return cJSON_CreateString(value->text);
    default:
        return cJSON_CreateDoubleArray(value->numbers,
                                       (int)parameter_component_count(parameter->type));
    }
}
