// One error message, filled by the function that knows the cause and passed up unchanged.
#ifndef VOXCAST_RENDERER_ERROR_H
#define VOXCAST_RENDERER_ERROR_H

#include <stdbool.h>

#define ERROR_MESSAGE_SIZE 512

struct error {
    char message[ERROR_MESSAGE_SIZE];
};

// Writes a printf-style message (what, which object, what to do) and returns false, so that a
// caller can write `return error_set(out_error, ...)`. `out_error` may be NULL.
bool error_set(struct error *out_error, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

#endif
