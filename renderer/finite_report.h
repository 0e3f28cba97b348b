// Result of a search for NaN and infinity: plain data.
#ifndef VOXCAST_RENDERER_FINITE_REPORT_H
#define VOXCAST_RENDERER_FINITE_REPORT_H

#include <stdint.h>

#define FINITE_MAX_RESOURCES 16u

// NaN and infinity found in one resource on the GPU.
struct finite_report {
    uint32_t count;
    struct finite_resource {
        const char *name;
        uint32_t values; // count of NaN and infinity
        uint32_t first;  // first such word of the buffer, or texel; valid if values > 0
    } resources[FINITE_MAX_RESOURCES];
};

#endif
