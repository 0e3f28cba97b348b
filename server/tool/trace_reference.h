// voxcast render --gi reference: images by the reference path tracer, without a GPU.
#ifndef VOXCAST_SERVER_ACCURACY_TRACE_REFERENCE_H
#define VOXCAST_SERVER_ACCURACY_TRACE_REFERENCE_H

#include "server/tool/shot_options.h"

struct cli_reference_options {
    uint32_t samples;   // per pixel; 0: as many as time and noise allow
    double time_s;      // at most; 0: no limit
    double noise;       // trace until the estimate is below this; 0: do not stop by noise
    uint32_t bounces;   // of indirect light; REFERENCE_UNLIMITED if not given
    uint32_t light;     // an enum cli_reference_light
    uint32_t bounce;    // the image of this bounce alone, 1 or more; 0: of all
    uint32_t estimator; // an enum reference_estimator
    uint32_t seed, threads;
};

enum cli_reference_light { CLI_LIGHT_ALL, CLI_LIGHT_DIRECT, CLI_LIGHT_INDIRECT, CLI_LIGHT_COUNT };

// Declares --spp, --time, --noise, --bounces, --light, --bounce, --estimator, --seed and --threads,
// and initializes their values.
void cli_take_reference(struct cli_parser *parser, struct cli_reference_options *target);

// Renders the shot, which needs no renderer, and writes `out` and, unless NULL, `stats`. Returns
// the exit status.
int cli_render_reference(const struct cli_reference_options *options, const struct shot *shot,
                         const char *out, const char *stats);

// Writes JSON to a file.
struct cJSON;
bool cli_write_json(const char *path, const struct cJSON *json, struct error *out_error);

#endif
