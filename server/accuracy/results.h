// Results of measuring, as results.json has them.
#ifndef VOXCAST_SERVER_ACCURACY_RESULTS_H
#define VOXCAST_SERVER_ACCURACY_RESULTS_H

#include "server/accuracy/sweep.h"

// Noise of the reference image over the smallest error, up to which errors are believed.
#define RESULTS_NOISE_FRACTION 0.1

struct cJSON;

// Results of a run: {"setup", "metrics", "rungs", "noise"}; the last compares the noise of the
// truth with the smallest error of a final image, both over the mean of the reference image.
//
// Reads the folder's results.json if it is of the same set-up, else starts anew. `setup` is taken
// over. `out_kept` says how many configurations are there already.
struct cJSON *results_open(const char *folder, struct cJSON *setup, uint32_t *out_kept);

// The configuration's entry, or NULL.
const struct cJSON *results_find(const struct cJSON *results,
                                 const struct configuration *configuration);

// Adds an entry (taken over) in the place of one of the same name, and marks the Pareto front of
// each metric anew: configurations than which none is both faster and less wrong.
void results_add(struct cJSON *results, struct cJSON *entry);

// Writes results.json: whole, or it stays as it was.
bool results_write(const struct cJSON *results, const char *folder, struct error *out_error);

// Writes results.csv and the page: index.html, its scripts, results.js.
bool results_write_report(const struct cJSON *results, const char *folder, struct error *out_error);

#endif
