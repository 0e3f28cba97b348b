// Times of one thing over several frames, and their quantiles.
#ifndef VOXCAST_SERVER_ACCURACY_SAMPLES_H
#define VOXCAST_SERVER_ACCURACY_SAMPLES_H

#include <stdbool.h>
#include <stdint.h>

// Times of one thing over several frames.
struct samples {
    uint32_t count;
    uint32_t capacity;
    double *values;
};

bool samples_add(struct samples *samples, double value);
void samples_finish(struct samples *samples);

// The value below which the fraction `quantile` of the samples lies (nearest rank); 0 without
// samples.
double samples_quantile(const struct samples *samples, double quantile);

#endif
