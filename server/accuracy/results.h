// Results of measuring, as results.json has them.
#ifndef VOXCAST_SERVER_ACCURACY_RESULTS_H
#define VOXCAST_SERVER_ACCURACY_RESULTS_H

#include "server/accuracy/sweep.h"

// Up to this ratio of the reference image's noise to the smallest error, errors are trusted.
#define RESULTS_NOISE_FRACTION 0.1

struct cJSON;

// Results of a run: {"setup", "metrics", "rungs", "noise"}. "noise" compares the noise of the
// reference image with the smallest error of a final image, both over the mean of the reference
// image.
//
// Reads the folder's results.json if it has the same set-up, else starts a new one. Takes over
// `setup`. `out_kept` is the number of configurations that are there already.
struct cJSON *results_open(const char *folder, struct cJSON *setup, uint32_t *out_kept);

// The configuration's entry, or NULL.
const struct cJSON *results_find(const struct cJSON *results,
                                 const struct configuration *configuration);

// Takes over an entry, which replaces one of the same name. Marks the Pareto front of each metric
// anew: the configurations for which no other is both faster and less wrong.
void results_add(struct cJSON *results, struct cJSON *entry);

// Writes results.json completely, or leaves it as it was.
bool results_write(const struct cJSON *results, const char *folder, struct error *out_error);

// Writes results.csv and the page: index.html, its scripts, results.js.
bool results_write_report(const struct cJSON *results, const char *folder, struct error *out_error);

#endif
