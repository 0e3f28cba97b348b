// Pass timers: GPU timestamps read back frames later without stalling, or the clock where the
// driver runs dispatches synchronously and timer queries see nothing.
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

// Takes in what has arrived. Time of the newest measured run of a slot in ms; 0 before the first.
void gpu_timer_poll(struct gpu_timer *timer);
double gpu_timer_get_ms(const struct gpu_timer *timer, uint32_t slot);

// Tells whether GL timer queries see compute dispatches on this driver.
bool gpu_timer_probe(struct gpu *gpu);

#endif
