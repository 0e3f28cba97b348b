// One checked value of a parameter: read from JSON or text, held as plain data, written as JSON.
#ifndef VOXCAST_PROTOCOL_PARAMETER_VALUE_H
#define VOXCAST_PROTOCOL_PARAMETER_VALUE_H

#include "protocol/limits.h"
#include "protocol/parameters.h"
#include "protocol/rpc.h"

struct parameter_value {
    const struct parameter *parameter;
    double numbers[4];                      // components; bool: 0 or 1; enum: index in `values`
    char text[PROTOCOL_MAX_NAME_BYTES + 1]; // of a string
};

// Both refuse values of another type, values that are not finite, and values out of range. They
// name field, value and range in `out_error` and leave `out_value` untouched.
bool parameter_value_from_json(const struct parameter *parameter, const struct cJSON *item,
                               struct parameter_value *out_value, struct rpc_error *out_error);

// Text as a person types it: `20`, `true`, `0,1,0`, `hable`.
bool parameter_value_from_text(const struct parameter *parameter, const char *text,
                               struct parameter_value *out_value, struct rpc_error *out_error);

// The caller owns the result; NULL when out of memory.
struct cJSON *parameter_value_to_json(const struct parameter_value *value);

#endif
