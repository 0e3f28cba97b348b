#include "server/accuracy/samples.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

bool samples_add(struct samples *samples, double value)
{
    if (samples->count == samples->capacity) {
        uint32_t capacity = samples->capacity ? 2 * samples->capacity : 64;
        double *grown = realloc(samples->values, capacity * sizeof(*grown));
        if (!grown)
            return false;
        samples->values = grown;
        samples->capacity = capacity;
    }
    samples->values[samples->count++] = value;
    return true;
}

void samples_finish(struct samples *samples)
{
    free(samples->values);
    *samples = (struct samples){0};
}

static int compare_doubles(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

double samples_quantile(const struct samples *samples, double quantile)
{
    if (samples->count == 0)
        return 0.0;
    double *sorted = malloc(samples->count * sizeof(*sorted));
    if (!sorted)
        return 0.0;
    memcpy(sorted, samples->values, samples->count * sizeof(*sorted));
    qsort(sorted, samples->count, sizeof(*sorted), compare_doubles);
    double rank = ceil(quantile * samples->count);
    double value = sorted[rank < 1.0 ? 0 : (uint32_t)rank - 1];
    free(sorted);
    return value;
}
