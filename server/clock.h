// The one clock of the server: monotonic. Any thread.
#ifndef VOXCAST_SERVER_CLOCK_H
#define VOXCAST_SERVER_CLOCK_H

#include <stdint.h>
#include <time.h>

static inline uint64_t clock_now_us(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (uint64_t)now.tv_sec * 1000000u + (uint64_t)now.tv_nsec / 1000u;
}

static inline double clock_now_ms(void)
{
    return (double)clock_now_us() * 1e-3;
}

#endif
