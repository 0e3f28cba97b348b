#include "renderer/log.h"

#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <time.h>

#define LOG_LINE_SIZE 1024

static _Atomic int current_level = LOG_INFO;

void log_set_level(enum log_level level)
{
    atomic_store(&current_level, (int)level);
}

void log_write(enum log_level level, const char *format, ...)
{
    static const char *const level_names[] = {"error", "warn", "info", "debug"};
    if ((int)level > atomic_load(&current_level))
        return;
    char message[LOG_LINE_SIZE];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message, sizeof(message), format, arguments);
    va_end(arguments);

    struct timespec now;
    clock_gettime(CLOCK_REALTIME, &now);
    struct tm utc;
    gmtime_r(&now.tv_sec, &utc);
    char stamp[32];
    strftime(stamp, sizeof(stamp), "%Y-%m-%dT%H:%M:%S", &utc);
    // One call per line keeps the lines of several threads apart.
    fprintf(stderr, "time=%s.%03ldZ level=%s event=%s\n", stamp, now.tv_nsec / 1000000,
            level_names[level], message);
}
