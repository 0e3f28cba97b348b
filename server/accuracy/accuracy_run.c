// A whole run: the reference image, then every configuration that is not measured yet.
#include <cjson/cJSON.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "server/accuracy/accuracy.h"
#include "server/accuracy/picture_file.h"
#include "renderer/clock.h"

#define SELF_LIT_MARGIN 2 // pixels: as far as upsampling from draft quality reaches

static bool write_reference_png(const struct accuracy *accuracy, struct error *out_error)
{
    const struct picture *reference_image =
        &accuracy->reference_image.pictures[REFERENCE_IMAGE_ALL];
    char path[4096];
    uint8_t *rgb = malloc(3 * picture_pixel_count(reference_image));
    if (!rgb)
        return error_set(out_error, "out of memory");
    display_bytes(&accuracy->display, reference_image, rgb);
    snprintf(path, sizeof(path), "%s/reference.png", accuracy->folder);
    bool done = picture_file_write_png(path, reference_image->width, reference_image->height, rgb,
                                       out_error);
    free(rgb);
    return done;
}

// Marks the pixels whose rays hit nothing or an emitter, and the pixels near them.
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
        exposure *=
            display_automatic_exposure(&accuracy->reference_image.pictures[REFERENCE_IMAGE_ALL]);
    accuracy->display = (struct display_params){
        .exposure = exposure, .tonemap = settings->tonemap, .gamma = settings->gamma};
}

// Progress of the configurations, and the time they took in this run.
struct climb {
    const struct accuracy_run *run;
    const cJSON *results;
    double started_ms;
    uint32_t measured_count;
    const struct configuration *measured; // newest
    double measured_s;
};

static bool tell(const struct climb *climb)
{
    const struct accuracy_watch *watch = &climb->run->watch;
    const struct sweep *sweep = climb->run->sweep;
    struct accuracy_progress progress = {.stage = ACCURACY_MEASURING,
                                         .configuration_count = sweep->configuration_count,
                                         .measured = climb->measured,
                                         .measured_s = climb->measured_s,
                                         .left_s = NAN};
    for (uint32_t i = 0; i < sweep->configuration_count; i++)
        if (results_find(climb->results, &sweep->configurations[i]))
            progress.done++;
        else if (!progress.next)
            progress.next = &sweep->configurations[i];
    if (climb->measured_count > 0)
        progress.left_s = 1e-3 * (clock_now_ms() - climb->started_ms) / climb->measured_count *
                          (progress.configuration_count - progress.done);
    return !watch->tell || watch->tell(watch->user, &progress);
}

static bool write_results(const struct climb *climb, struct error *out_error)
{
    const char *folder = climb->run->accuracy->folder;
    return results_write(climb->results, folder, out_error) &&
           (!climb->run->with_report || results_write_report(climb->results, folder, out_error));
}

// Measures a configuration and writes all results anew.
static bool measure_configuration(struct climb *climb, const struct configuration *configuration,
                                  cJSON *results, struct error *out_error)
{
    double started_ms = clock_now_ms();
    cJSON *entry = accuracy_measure(climb->run->accuracy, configuration, out_error);
    if (!entry)
        return false;
    results_add(results, entry);
    climb->measured = configuration;
    climb->measured_s = 1e-3 * (clock_now_ms() - started_ms);
    climb->measured_count++;
    return write_results(climb, out_error) &&
           (tell(climb) ||
            error_set(out_error, "stopped after configuration %s", configuration->name));
}

// Measures the configurations that have no results yet.
static bool measure_configurations(const struct accuracy_run *run, cJSON *results,
                                   struct error *out_error)
{
    struct climb climb = {.run = run, .results = results, .started_ms = clock_now_ms()};
    bool done = tell(&climb) || error_set(out_error, "stopped before the first configuration");
    for (uint32_t i = 0; i < run->sweep->configuration_count && done; i++)
        if (!results_find(results, &run->sweep->configurations[i]))
            done =
                measure_configuration(&climb, &run->sweep->configurations[i], results, out_error);
    // Even with nothing to measure, the report may be from an older program.
    return done && (climb.measured_count > 0 || write_results(&climb, out_error));
}

cJSON *accuracy_run(const struct accuracy_run *run, struct error *out_error)
{
    struct accuracy *accuracy = run->accuracy;
    uint32_t kept;
    if (!reference_image_get(run->reference_image, &accuracy->reference_image, out_error))
        return NULL;
    choose_display(accuracy);
    bool done = find_self_lit(accuracy, out_error) && write_reference_png(accuracy, out_error);
    cJSON *setup = done ? accuracy_setup(accuracy, run->reference_image->path,
                                         run->reference_image->identity, out_error)
                        : NULL;
    cJSON *results = setup ? results_open(accuracy->folder, setup, &kept) : NULL;
    if (results && !measure_configurations(run, results, out_error)) {
        cJSON_Delete(results);
        results = NULL;
    }
    reference_image_finish(&accuracy->reference_image);
    free(accuracy->self_lit);
    accuracy->self_lit = NULL;
    return results;
}
