#include "protocol/parameters/enums.h"

#define ENUM_BEGIN(name)           const char *const name##_names[] = {
#define ENUM_VALUE(constant, text) [constant] = text,
#define ENUM_END(name, count)                                                                      \
    [count] = 0                                                                                    \
    }                                                                                              \
    ;
#include "protocol/parameters/enums.def"
#undef ENUM_BEGIN
#undef ENUM_VALUE
#undef ENUM_END
