// Measured frames of a camera that sways around its target.
#ifndef VOXCAST_SERVER_ACCURACY_BENCH_RUN_H
#define VOXCAST_SERVER_ACCURACY_BENCH_RUN_H

#include "renderer/renderer.h"
#include "server/accuracy/measurement.h"

struct bench_run {
    struct renderer *renderer;
    const struct scene *scene;
    struct frame_params params;   // its camera is where the swaying begins
    uint32_t frames;              // measured
    double enough_ms;             // measured for so long, no more frames are; 0: all of them are
    uint32_t warm_up_frames;      // of the swaying camera, not measured
    uint32_t max_converge_frames; // drawn before, at the start, until nothing changes; 0 for none
};

struct bench_result {
    struct measurement measurement;
    struct frame_statistics statistics; // of the newest frame
    uint32_t converge_frames;           // as many as were needed
    float convergence;                  // of the newest frame
};

// Draws and measures in a view of its own. The result is to be finished in any case.
bool bench_measure(const struct bench_run *run, struct bench_result *out_result,
                   struct error *out_error);
void bench_result_finish(struct bench_result *result);

// As measurement_json().
struct cJSON *bench_result_json(const struct bench_run *run, const struct bench_result *result);

void bench_print_json(const struct cJSON *json); // to stdout

// A pass's median over all measured frames: 0 if it ran in less than half of them.
double bench_pass_ms(const struct bench_result *result, uint32_t pass);

uint64_t bench_memory_bytes(const struct bench_result *result); // all of it

#endif
