#include "renderer/parameter_types.h"

#define ENUM_BEGIN(name)           const char *const name##_names[] = {
#define ENUM_VALUE(constant, text) [constant] = text,
#define ENUM_END(name, count)                                                                      \
    }                                                                                              \
    ;
#include "protocol/parameters/enums.def"
#undef ENUM_BEGIN
#undef ENUM_VALUE
#undef ENUM_END
