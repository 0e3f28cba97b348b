// Looks for NaN and infinity in what a frame wrote and read: see renderer_check_finite().
#ifndef VOXCAST_RENDERER_FINITE_CHECK_H
#define VOXCAST_RENDERER_FINITE_CHECK_H

#include "renderer/error.h"
#include "renderer/finite_report.h"

struct gi_findings;
struct gpu;
struct gpu_scene;
struct view;

struct finite_check {
    struct gpu *gpu;
    const struct gpu_scene *gpu_scene; // NULL for none
    const struct view *view;
    const struct gi_findings *gi; // of the view's newest frame
};

// Runs on the render thread and waits for the GPU.
bool finite_check_run(const struct finite_check *check, struct finite_report *out_report,
                      struct error *out_error);

#endif
