#include "protocol/parameters.h"

#include <assert.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cjson/cJSON.h>

#include "protocol/parameter_value.h"
#include "protocol/parameters/enums.h"

const char *const parameter_group_names[GROUP_COUNT] = {
    "light", "material", "node", "environment", "settings", "animation", "view", "camera",
};

const char *const parameter_type_names[PARAMETER_TYPE_COUNT] = {
    "float", "int", "bool", "enum", "string", "vec3", "color", "color_alpha", "quaternion",
};

// Two records of the table belong to one group.
#define GROUP_LIGHT_PLACEMENT GROUP_LIGHT

// The columns of a row.
#define TYPE_FLOAT       .type = PARAMETER_FLOAT
#define TYPE_INT         .type = PARAMETER_INT
#define TYPE_BOOL        .type = PARAMETER_BOOL
#define TYPE_ENUM(name)  .type = PARAMETER_ENUM, .values = name##_names
#define TYPE_STRING      .type = PARAMETER_STRING
#define TYPE_VEC3        .type = PARAMETER_VEC3
#define TYPE_COLOR       .type = PARAMETER_COLOR
#define TYPE_COLOR_ALPHA .type = PARAMETER_COLOR_ALPHA
#define TYPE_QUATERNION  .type = PARAMETER_QUATERNION

#define RANGE(low, high, by) .min = low, .max = high, .step = by
#define NO_RANGE             .min = 0
#define VECTOR(...)          __VA_ARGS__
#define EMPTY                0
#define SETTLED              0
#define LIVE                 PARAMETER_LIVE
#define NONZERO              PARAMETER_NONZERO
#define VALUE(value)         (1u << (value))
#define NEEDS_NOTHING                                                                              \
    {                                                                                              \
        0                                                                                          \
    }
#define NEED(wanted, will_do, why)                                                                 \
    {                                                                                              \
        .name = #wanted, .values = will_do, .reason = why,                                         \
    }

#define PARAMETER(record, field, kind, range, measure, initial, handling, redraw, conditions,      \
                  text)                                                                            \
    {                                                                                              \
        .group = GROUP_##record,                                                                   \
        .name = #field,                                                                            \
        TYPE_##kind,                                                                               \
        range,                                                                                     \
        .unit = measure,                                                                           \
        .fallback = {initial},                                                                     \
        .flags = handling,                                                                         \
        .needs = {conditions},                                                                     \
        .doc = text,                                                                               \
    },

static const struct parameter parameters[] = {
#include "protocol/parameters/parameters.def"
};
#undef PARAMETER

size_t parameter_count(void)
{
    return sizeof(parameters) / sizeof(parameters[0]);
}

const struct parameter *parameter_at(size_t index)
{
    return &parameters[index];
}

const struct parameter *parameter_find(enum parameter_group group, const char *name)
{
    for (size_t i = 0; i < parameter_count(); i++) {
        if (parameters[i].group == group && strcmp(parameters[i].name, name) == 0)
            return &parameters[i];
    }
    return NULL;
}

uint32_t parameter_component_count(enum parameter_type type)
{
    switch (type) {
    case PARAMETER_STRING:
        return 0;
    case PARAMETER_VEC3:
    case PARAMETER_COLOR:
        return 3;
    case PARAMETER_COLOR_ALPHA:
    case PARAMETER_QUATERNION:
        return 4;
    default:
        return 1;
    }
}

uint32_t parameter_value_count(const struct parameter *parameter)
{
    uint32_t count = 0;
    while (parameter->values && parameter->values[count])
        count++;
    return count;
}

static bool has_range(const struct parameter *parameter)
{
    return parameter->min < parameter->max;
}

static cJSON *default_to_json(const struct parameter *parameter)
{
    struct parameter_value value = {.parameter = parameter};
    memcpy(value.numbers, parameter->fallback, sizeof(value.numbers));
    return parameter_value_to_json(&value);
}

// The allowed values, as JSON.
static cJSON *need_values_to_json(const struct parameter *needed, uint32_t values)
{
    cJSON *array = cJSON_CreateArray();
    uint32_t count = needed->type == PARAMETER_BOOL ? 2 : parameter_value_count(needed);
    for (uint32_t i = 0; i < count; i++) {
        const struct parameter_value value = {.parameter = needed, .numbers = {i}};
        if (values & 1u << i)
            cJSON_AddItemToArray(array, parameter_value_to_json(&value));
    }
    return array;
}

static cJSON *needs_to_json(const struct parameter *parameter)
{
    cJSON *array = cJSON_CreateArray();
    for (uint32_t i = 0; i < PARAMETER_MAX_NEEDS && parameter->needs[i].name; i++) {
        const struct parameter_need *need = &parameter->needs[i];
        const struct parameter *needed = parameter_find(parameter->group, need->name);
        assert(needed); // a test looks up all of them
        cJSON *object = cJSON_CreateObject();
        cJSON_AddStringToObject(object, "name", need->name);
        cJSON_AddItemToObject(object, "in", need_values_to_json(needed, need->values));
        cJSON_AddStringToObject(object, "reason", need->reason);
        cJSON_AddItemToArray(array, object);
    }
    return array;
}

static cJSON *parameter_to_json(const struct parameter *parameter)
{
    cJSON *object = cJSON_CreateObject();
    cJSON_AddStringToObject(object, "group", parameter_group_names[parameter->group]);
    cJSON_AddStringToObject(object, "name", parameter->name);
    cJSON_AddStringToObject(object, "type", parameter_type_names[parameter->type]);
    if (has_range(parameter)) {
        cJSON_AddNumberToObject(object, "min", parameter->min);
        cJSON_AddNumberToObject(object, "max", parameter->max);
        cJSON_AddNumberToObject(object, "step", parameter->step);
    }
    cJSON_AddStringToObject(object, "unit", parameter->unit);
    cJSON_AddItemToObject(object, "default", default_to_json(parameter));
    if (parameter->values)
        cJSON_AddItemToObject(
            object, "values",
            cJSON_CreateStringArray(parameter->values, (int)parameter_value_count(parameter)));
    cJSON_AddBoolToObject(object, "live", parameter->flags & PARAMETER_LIVE);
    if (parameter->needs[0].name)
        cJSON_AddItemToObject(object, "needs", needs_to_json(parameter));
    cJSON_AddStringToObject(object, "doc", parameter->doc);
    return object;
}

cJSON *parameters_to_json(void)
{
    cJSON *array = cJSON_CreateArray();
    for (size_t i = 0; i < parameter_count(); i++)
        cJSON_AddItemToArray(array, parameter_to_json(&parameters[i]));
    return array;
}

static void write_range(const struct parameter *parameter, char *out, size_t size)
{
    size_t used = 0;
    out[0] = '\0';
    if (has_range(parameter))
        snprintf(out, size, "%g to %g", parameter->min, parameter->max);
    for (uint32_t i = 0; i < parameter_value_count(parameter) && used < size; i++)
        used +=
            (size_t)snprintf(out + used, size - used, "%s%s", i ? ", " : "", parameter->values[i]);
}

int parameter_write_markdown_row(const struct parameter *parameter, char *out, size_t size)
{
    char range[512];
    write_range(parameter, range, sizeof(range));
    cJSON *item = default_to_json(parameter);
    char *fallback = cJSON_PrintUnformatted(item);
    int length = snprintf(out, size, "| %s | %s | %s | %s | %s | `%s` | %s | %s |",
                          parameter_group_names[parameter->group], parameter->name,
                          parameter_type_names[parameter->type], range, parameter->unit,
                          fallback ? fallback : "", parameter->flags & PARAMETER_LIVE ? "live" : "",
                          parameter->doc);
    free(fallback);
    cJSON_Delete(item);
    return length;
}
