// The one table of parameters: what can be set, its type, range, unit, default and meaning.
//
// Validation, the browser's panel, the offline tool's --set and the table in PROTOCOL.md all come
// from it. Its rows are in parameters/*.def. Pure data; any thread.
#ifndef VOXCAST_PROTOCOL_PARAMETERS_H
#define VOXCAST_PROTOCOL_PARAMETERS_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct cJSON;

enum parameter_group {
    GROUP_LIGHT,
    GROUP_MATERIAL,
    GROUP_NODE,
    GROUP_ENVIRONMENT,
    GROUP_SETTINGS,
    GROUP_ANIMATION,
    GROUP_VIEW,
    GROUP_CAMERA,
    GROUP_COUNT
};

enum parameter_type {
    PARAMETER_FLOAT,
    PARAMETER_INT,
    PARAMETER_BOOL,
    PARAMETER_ENUM,        // one of `values`
    PARAMETER_STRING,      // at most PROTOCOL_MAX_NAME_BYTES bytes of UTF-8
    PARAMETER_VEC3,        // [x, y, z]
    PARAMETER_COLOR,       // [r, g, b], linear Rec.709
    PARAMETER_COLOR_ALPHA, // [r, g, b, a]
    PARAMETER_QUATERNION,  // [x, y, z, w], made unit length when applied
    PARAMETER_TYPE_COUNT
};

enum parameter_flags {
    PARAMETER_LIVE = 1,    // a uniform or a table entry: dragging it rebuilds nothing
    PARAMETER_NONZERO = 2, // a vector that must not be zero
};

#define PARAMETER_MAX_NEEDS 2u

// What another parameter of the group must be so that this one has an effect.
struct parameter_need {
    const char *name; // NULL: none
    uint32_t values; // those that are enough: a bit for each index in `values` of an enum; bit 1 of
                     // a bool
    const char *reason; // shown to people where the other parameter has none of these values
};

struct parameter {
    enum parameter_group group;
    const char *name;
    enum parameter_type type;
    uint32_t flags;
    double min, max, step;     // of each component; 0, 0, 0 for types without a range
    const char *unit;          // "" for none
    double fallback[4];        // the default, as the numbers of struct parameter_value
    const char *const *values; // of an enum, ended by NULL; else NULL
    struct parameter_need needs[PARAMETER_MAX_NEEDS];
    const char *doc;
};

extern const char *const parameter_group_names[GROUP_COUNT];
extern const char *const parameter_type_names[PARAMETER_TYPE_COUNT];

size_t parameter_count(void);
const struct parameter *parameter_at(size_t index);

// NULL if there is none.
const struct parameter *parameter_find(enum parameter_group group, const char *name);

// Numbers in a value of this type: 1, 3 or 4; 0 for a string.
uint32_t parameter_component_count(enum parameter_type type);
uint32_t parameter_value_count(const struct parameter *parameter); // of an enum

// The whole table as a JSON array, as session.hello returns it. The caller owns it; NULL when out
// of memory.
struct cJSON *parameters_to_json(void);

// One parameter as a row of the table in PROTOCOL.md, without the line's end. Returns the length.
int parameter_write_markdown_row(const struct parameter *parameter, char *out, size_t size);

#endif
