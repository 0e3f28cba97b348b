// What the files of the suite's harness share; cases include stability.h.
#ifndef VOXCAST_SERVER_TOOL_STABILITY_STABILITY_INTERNAL_H
#define VOXCAST_SERVER_TOOL_STABILITY_STABILITY_INTERNAL_H

#include "renderer/metrics/picture.h"
#include "server/tool/stability/stability.h"

// One run of the suite.
struct stability {
    const char *gpu;
    const char *folder; // NULL for none
    struct renderer *renderer;
    uint64_t gl_errors;                    // of the renderer, reported already
    struct picture usual[GI_METHOD_COUNT]; // of the default stage, once drawn; owned
    char gl_renderer[128];
    double seconds;
    uint32_t run_count, failures, known;
    struct cJSON *results; // owned; an array
};

void stability_end_renderer(struct stability *suite);

// Writes results.json into the folder.
bool stability_write_results(const struct stability *suite, struct error *out_error);

#endif
