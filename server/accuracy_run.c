// A whole run: the truth, then every rung that is not there yet.
#include <cjson/cJSON.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "server/accuracy.h"
#include "server/cli.h"
#include "server/clock.h"

#define SELF_LIT_MARGIN 2 // pixels, as far as resampling at draft quality reaches

static bool write_reference_png(const struct accuracy *accuracy, struct error *out_error)
{
    const struct picture *truth = &accuracy->truth.pictures[TRUTH_ALL];
    char path[4096];
    uint8_t *rgb = malloc(3 * picture_pixel_count(truth));
    if (!rgb)
        return error_set(out_error, "out of memory");
    display_bytes(&accuracy->display, truth, rgb);
    snprintf(path, sizeof(path), "%s/reference.png", accuracy->folder);
    bool done = cli_write_png(path, truth->width, truth->height, rgb, out_error);
    free(rgb);
    return done;
}

// Marks the pixels whose rays meet nothing or what shines, and those near by.
static bool find_self_lit(struct accuracy *accuracy, struct error *out_error)
{
    const struct frame_params *params = &accuracy->shot.params;
    const struct scene *scene = accuracy->shot.scene;
    int width = (int)params->width, height = (int)params->height;
    accuracy->self_lit = calloc((size_t)width * (size_t)height, sizeof(bool));
    if (!accuracy->self_lit)
        return error_set(out_error, "out of memory");
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++) {
            struct ray_hit hit;
            if (renderer_pick(accuracy->shot.renderer, &params->camera, params->width,
                              params->height, (float)x, (float)y, &hit)) {
                const struct scene_material *material = &scene->materials[hit.material];
                if (material->emissive_strength *
                        (material->emissive[0] + material->emissive[1] + material->emissive[2]) ==
                    0.0f)
                    continue;
            }
            for (int j = y - SELF_LIT_MARGIN; j <= y + SELF_LIT_MARGIN; j++)
                for (int i = x - SELF_LIT_MARGIN; i <= x + SELF_LIT_MARGIN; i++)
                    if (i >= 0 && i < width && j >= 0 && j < height)
                        accuracy->self_lit[j * width + i] = true;
        }
    return true;
}

static void choose_display(struct accuracy *accuracy)
{
    const struct render_settings *settings = &accuracy->shot.params.settings;
    float exposure = exp2f(settings->exposure_ev);
    if (settings->exposure_mode == EXPOSURE_AUTOMATIC)
        exposure *= display_automatic_exposure(&accuracy->truth.pictures[TRUTH_ALL]);
    accuracy->display = (struct display_params){
        .exposure = exposure, .tonemap = settings->tonemap, .gamma = settings->gamma};
}

// How far the rungs are, and what they took in this run.
struct climb {
    const struct accuracy_run *run;
    const cJSON *results;
    double started_ms;
    uint32_t measured_count;
    const struct rung *measured; // newest
    double measured_s;
};

static bool tell(const struct climb *climb)
{
    const struct accuracy_watch *watch = &climb->run->watch;
    const struct ladder *ladder = climb->run->ladder;
    struct accuracy_progress progress = {.stage = ACCURACY_MEASURING,
                                         .rung_count = ladder->rung_count,
                                         .measured = climb->measured,
                                         .measured_s = climb->measured_s,
                                         .left_s = NAN};
    for (uint32_t i = 0; i < ladder->rung_count; i++)
        if (results_find(climb->results, &ladder->rungs[i]))
            progress.done++;
        else if (!progress.next)
            progress.next = &ladder->rungs[i];
    if (climb->measured_count > 0)
        progress.left_s = 1e-3 * (clock_now_ms() - climb->started_ms) / climb->measured_count *
                          (progress.rung_count - progress.done);
    return !watch->tell || watch->tell(watch->user, &progress);
}

static bool write_results(const struct climb *climb, struct error *out_error)
{
    const char *folder = climb->run->accuracy->folder;
    return results_write(climb->results, folder, out_error) &&
           (!climb->run->with_report || results_write_report(climb->results, folder, out_error));
}

// Measures a rung and writes everything anew.
static bool measure_rung(struct climb *climb, const struct rung *rung, cJSON *results,
                         struct error *out_error)
{
    double started_ms = clock_now_ms();
    cJSON *entry = accuracy_measure(climb->run->accuracy, rung, out_error);
    if (!entry)
        return false;
    results_add(results, entry);
    climb->measured = rung;
    climb->measured_s = 1e-3 * (clock_now_ms() - started_ms);
    climb->measured_count++;
    return write_results(climb, out_error) &&
           (tell(climb) || error_set(out_error, "stopped after rung %s", rung->name));
}

// Measures the rungs that are not there yet.
static bool measure_rungs(const struct accuracy_run *run, cJSON *results, struct error *out_error)
{
    struct climb climb = {.run = run, .results = results, .started_ms = clock_now_ms()};
    bool done = tell(&climb) || error_set(out_error, "stopped before the first rung");
    for (uint32_t i = 0; i < run->ladder->rung_count && done; i++)
        if (!results_find(results, &run->ladder->rungs[i]))
            done = measure_rung(&climb, &run->ladder->rungs[i], results, out_error);
    // With nothing to measure, the report may still be an older program's.
    return done && (climb.measured_count > 0 || write_results(&climb, out_error));
}

cJSON *accuracy_run(const struct accuracy_run *run, struct error *out_error)
{
    struct accuracy *accuracy = run->accuracy;
    uint32_t kept;
    if (!truth_get(run->truth, &accuracy->truth, out_error))
        return NULL;
    choose_display(accuracy);
    bool done = find_self_lit(accuracy, out_error) && write_reference_png(accuracy, out_error);
    cJSON *setup =
        done ? accuracy_setup(accuracy, run->truth->path, run->truth->identity, out_error) : NULL;
    cJSON *results = setup ? results_open(accuracy->folder, setup, &kept) : NULL;
    if (results && !measure_rungs(run, results, out_error)) {
        cJSON_Delete(results);
        results = NULL;
    }
    truth_finish(&accuracy->truth);
    free(accuracy->self_lit);
    accuracy->self_lit = NULL;
    return results;
}
