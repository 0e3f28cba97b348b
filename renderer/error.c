#include "renderer/error.h"

#include <stdarg.h>
#include <stdio.h>

bool error_set(struct error *out_error, const char *format, ...)
{
    if (!out_error)
        return false;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(out_error->message, sizeof(out_error->message), format, arguments);
    va_end(arguments);
    return false;
}
