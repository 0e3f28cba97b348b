// Pass timers: GPU timestamps, read frames later without stalling; or the clock, if the driver runs
// dispatches synchronously and timer queries miss them.
#ifndef VOXCAST_RENDERER_GPU_TIMER_H
#define VOXCAST_RENDERER_GPU_TIMER_H

#include "renderer/gpu/gpu.h"

#define GPU_TIMER_SLOTS 40u

struct gpu_timer;

// Timers of one view: GPU_TIMER_SLOTS slots, each measured at most once per frame.
struct gpu_timer *gpu_timer_create(struct gpu *gpu);
void gpu_timer_destroy(struct gpu_timer **timer);

void gpu_timer_begin_frame(struct gpu_timer *timer);
void gpu_timer_begin(struct gpu_timer *timer, uint32_t slot);
void gpu_timer_end(struct gpu_timer *timer, uint32_t slot);

// Collects results that have arrived. gpu_timer_get_ms(): newest result of a slot in ms, 0 before
// the first.
void gpu_timer_poll(struct gpu_timer *timer);
double gpu_timer_get_ms(const struct gpu_timer *timer, uint32_t slot);

// Whether GL timer queries measure compute dispatches on this driver.
bool gpu_timer_probe(struct gpu *gpu);

#endif
