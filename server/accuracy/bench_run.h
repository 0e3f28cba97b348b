// Measured frames of a camera that swings around its target.
#ifndef VOXCAST_SERVER_ACCURACY_BENCH_RUN_H
#define VOXCAST_SERVER_ACCURACY_BENCH_RUN_H

#include "renderer/renderer.h"
#include "server/accuracy/measurement.h"

struct bench_run {
    struct renderer *renderer;
    const struct scene *scene;
    struct frame_params params;   // its camera is where the swing begins
    uint32_t frames;              // to measure
    double enough_ms;             // stop after this time; 0: measure all frames
    uint32_t warm_up_frames;      // of the swinging camera, not measured
    uint32_t max_converge_frames; // drawn first, until nothing changes; 0 for none
};

struct bench_result {
    struct measurement measurement;
    struct frame_statistics statistics; // of the newest frame
    uint32_t converge_frames;           // how many were drawn
    float convergence;                  // of the newest frame
};

// Draws and measures in a view of its own. Finish the result in any case.
bool bench_measure(const struct bench_run *run, struct bench_result *out_result,
                   struct error *out_error);
void bench_result_finish(struct bench_result *result);

// As measurement_json().
struct cJSON *bench_result_json(const struct bench_run *run, const struct bench_result *result);

void bench_print_json(const struct cJSON *json); // to stdout

// The median over all measured frames of a pass; 0 if it ran in less than half of them.
double bench_pass_ms(const struct bench_result *result, uint32_t pass);

uint64_t bench_memory_bytes(const struct bench_result *result); // sum over all categories

#endif
