// The parameter table as C types: its enums, and macros that make structs and defaults from its
// rows. Plain data.
#ifndef VOXCAST_RENDERER_PARAMETER_TYPES_H
#define VOXCAST_RENDERER_PARAMETER_TYPES_H

#include <stdbool.h>
#include <stdint.h>

#include "protocol/parameters/enums.h"

// What a change of a parameter invalidates.
enum invalidation {
    INVALIDATES_NOTHING = 0,
    INVALIDATES_SURFACES = 1 << 0,     // visibility: ids, depth, G-buffer
    INVALIDATES_LIGHT = 1 << 1,        // light in voxels and the irradiance cache
    INVALIDATES_ACCUMULATION = 1 << 2, // samples accumulated while nothing moves
    INVALIDATES_SHADING = 1 << 3,      // radiance of pixels, from the above
    INVALIDATES_DISPLAY = 1 << 4,      // exposure and tone curve: the image, from radiance

    // A part with everything that is computed from it.
    INVALIDATES_FROM_DISPLAY = INVALIDATES_DISPLAY,
    INVALIDATES_FROM_SHADING = INVALIDATES_SHADING | INVALIDATES_FROM_DISPLAY,
    INVALIDATES_FROM_ACCUMULATION = INVALIDATES_ACCUMULATION | INVALIDATES_FROM_SHADING,
    INVALIDATES_FROM_LIGHT = INVALIDATES_LIGHT | INVALIDATES_FROM_ACCUMULATION,
    INVALIDATES_FROM_SURFACES = INVALIDATES_SURFACES | INVALIDATES_FROM_ACCUMULATION,
    INVALIDATES_EVERYTHING = INVALIDATES_SURFACES | INVALIDATES_FROM_LIGHT,
};

#define PARAMETER_NAME_BYTES 64u // of a string, with its terminator

// PARAMETER_FIELD(type, name) declares the field of a parameter of that type.
#define PARAMETER_FIELD(type, name)   PARAMETER_ELEMENT_##type name PARAMETER_EXTENT_##type;
#define PARAMETER_ELEMENT_FLOAT       float
#define PARAMETER_ELEMENT_INT         uint32_t
#define PARAMETER_ELEMENT_BOOL        bool
#define PARAMETER_ELEMENT_ENUM(name)  enum name
#define PARAMETER_ELEMENT_STRING      char
#define PARAMETER_ELEMENT_VEC3        float
#define PARAMETER_ELEMENT_COLOR       float
#define PARAMETER_ELEMENT_COLOR_ALPHA float
#define PARAMETER_ELEMENT_QUATERNION  float
#define PARAMETER_EXTENT_FLOAT
#define PARAMETER_EXTENT_INT
#define PARAMETER_EXTENT_BOOL
#define PARAMETER_EXTENT_ENUM(name)
#define PARAMETER_EXTENT_STRING      [PARAMETER_NAME_BYTES]
#define PARAMETER_EXTENT_VEC3        [3]
#define PARAMETER_EXTENT_COLOR       [3]
#define PARAMETER_EXTENT_COLOR_ALPHA [4]
#define PARAMETER_EXTENT_QUATERNION  [4]

#endif
