// The statistics of a frame as JSON: for clients and for measurements, by one function.
#ifndef VOXCAST_SERVER_ACCURACY_STATISTICS_JSON_H
#define VOXCAST_SERVER_ACCURACY_STATISTICS_JSON_H

#include "renderer/renderer.h"

struct cJSON;

// What differs between those who read.
struct statistics_format {
    // Adds to a pass whether it ran and its times, between its name and its reason.
    void (*add_times)(struct cJSON *pass, const struct frame_statistics *statistics, uint32_t index,
                      const void *user);
    const void *user;
    const char *memory_key;
    bool lists; // amounts are [{"name", "bytes" or "count"}, ...]; else {NAME: AMOUNT, ...}
};

// Adds "passes", "effects", the memory and "rejects" to an object.
void statistics_add_json(struct cJSON *object, const struct frame_statistics *statistics,
                         const struct statistics_format *format);

#endif
