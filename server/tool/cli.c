#include "server/tool/cli.h"

#include <errno.h>
#include <stdarg.h>
#include <stdio.h>

#include "renderer/error.h"

int cli_fail(int status, const char *format, ...)
{
    char message[ERROR_MESSAGE_SIZE + 64];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message, sizeof(message), format, arguments);
    va_end(arguments);
    for (char *at = message; *at; at++) // one line, whatever a driver's log holds
        if (*at == '\n')
            *at = ' ';
    fprintf(stderr, "%s: %s\n", program_invocation_short_name, message);
    return status;
}
