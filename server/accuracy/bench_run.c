#include "server/accuracy/bench_run.h"

#include <cjson/cJSON.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/accuracy/converged_frames.h"

#define SWAY_STEP_RAD 0.03f
#define SWAY_RAD      0.3f

// Rotates the eye about the vertical axis through the target.
static void sway_camera(const struct view_camera *from, uint32_t frame, struct view_camera *to)
{
    *to = *from;
    float angle = SWAY_RAD * sinf((float)frame * SWAY_STEP_RAD);
    float x = from->eye[0] - from->target[0], z = from->eye[2] - from->target[2];
    to->eye[0] = from->target[0] + cosf(angle) * x + sinf(angle) * z;
    to->eye[2] = from->target[2] - sinf(angle) * x + cosf(angle) * z;
}

static bool converge(const struct bench_run *run, struct view *view, struct bench_result *result,
                     struct error *out_error)
{
    struct converged_frames render = {.renderer = run->renderer,
                                      .view = view,
                                      .params = &run->params,
                                      .max_frames = run->max_converge_frames};
    if (run->max_converge_frames == 0)
        return true;
    if (!frames_render_converged(&render, out_error))
        return false;
    result->converge_frames = render.frame_count;
    renderer_view_release(run->renderer, view);
    return true;
}

static bool measure_frame(const struct bench_run *run, struct view *view, uint32_t frame,
                          struct bench_result *result, struct error *out_error)
{
    struct frame_params params = run->params;
    struct frame_pixels pixels;
    sway_camera(&run->params.camera, frame + 1, &params.camera);
    if (!frames_render_next(run->renderer, view, &params, &pixels, out_error))
        return false;
    renderer_view_get_statistics(run->renderer, view, &result->statistics);
    result->convergence = pixels.convergence;
    renderer_view_release(run->renderer, view);
    return frame < run->warm_up_frames ||
           measurement_add(&result->measurement, &result->statistics) ||
           error_set(out_error, "out of memory");
}

bool bench_measure(const struct bench_run *run, struct bench_result *out_result,
                   struct error *out_error)
{
    *out_result = (struct bench_result){0};
    struct view *view = renderer_view_create(run->renderer);
    if (!view)
        return error_set(out_error, "out of memory");
    bool done = converge(run, view, out_result, out_error);
    double left_ms = run->enough_ms > 0.0 ? run->enough_ms : INFINITY;
    for (uint32_t i = 0; i < run->frames + run->warm_up_frames && done && left_ms > 0.0; i++) {
        done = measure_frame(run, view, i, out_result, out_error);
        left_ms -= i < run->warm_up_frames ? 0.0 : out_result->statistics.frame_time_ms;
    }
    renderer_view_destroy(run->renderer, &view);
    return done;
}

void bench_result_finish(struct bench_result *result)
{
    measurement_finish(&result->measurement);
}

cJSON *bench_result_json(const struct bench_run *run, const struct bench_result *result)
{
    return measurement_json(&result->measurement, &result->statistics,
                            renderer_get_info(run->renderer), run->scene, run->params.width,
                            run->params.height);
}

void bench_print_json(const cJSON *json)
{
    char *text = cJSON_Print(json);
    if (text)
        puts(text);
    cJSON_free(text);
}

double bench_pass_ms(const struct bench_result *result, uint32_t pass)
{
    const struct samples *samples = &result->measurement.pass_ms[pass];
    if (2 * samples->count < result->measurement.frame_ms.count)
        return 0.0;
    return samples_quantile(samples, 0.5);
}

uint64_t bench_memory_bytes(const struct bench_result *result)
{
    uint64_t bytes = 0;
    for (uint32_t i = 0; i < result->statistics.memory_count; i++)
        bytes += result->statistics.memory[i].bytes;
    return bytes;
}
