// The enums of enums.def in C, and their names as the protocol and the command line spell them.
#ifndef VOXCAST_PROTOCOL_PARAMETERS_ENUMS_H
#define VOXCAST_PROTOCOL_PARAMETERS_ENUMS_H

#define ENUM_BEGIN(name)           enum name {
#define ENUM_VALUE(constant, text) constant,
#define ENUM_END(name, count)                                                                      \
    count                                                                                          \
    }                                                                                              \
    ;
#include "protocol/parameters/enums.def"
#undef ENUM_BEGIN
#undef ENUM_VALUE
#undef ENUM_END

// gi_method_names[GI_METHOD_GRID] is "grid". A list ends with NULL.
#define ENUM_BEGIN(name)
#define ENUM_VALUE(constant, text)
#define ENUM_END(name, count) extern const char *const name##_names[count + 1];
#include "protocol/parameters/enums.def"
#undef ENUM_BEGIN
#undef ENUM_VALUE
#undef ENUM_END

#endif
