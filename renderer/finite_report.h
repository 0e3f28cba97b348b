// What a search for values that are not finite has found: plain data.
#ifndef VOXCAST_RENDERER_FINITE_REPORT_H
#define VOXCAST_RENDERER_FINITE_REPORT_H

#include <stdint.h>

#define FINITE_MAX_RESOURCES 16u

// What a look at the values that frames leave on the GPU has found.
struct finite_report {
    uint32_t count;
    struct finite_resource {
        const char *name;
        uint32_t values; // that are infinite or no numbers
        uint32_t first;  // word of the buffer, or texel, if there are any
    } resources[FINITE_MAX_RESOURCES];
};

#endif
