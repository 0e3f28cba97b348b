// The one clock of the renderer: monotonic, milliseconds. Any thread.
#ifndef VOXCAST_RENDERER_CLOCK_H
#define VOXCAST_RENDERER_CLOCK_H

#include <time.h>

static inline double clock_now_ms(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec * 1e3 + (double)now.tv_nsec / 1e6;
}

#endif
