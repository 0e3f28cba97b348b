// Measures one configuration of a sweep: its times, its images, and how far these are from the
// reference image.
#include <cjson/cJSON.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "renderer/metrics/heat_map.h"
#include "renderer/metrics/image_metrics.h"
#include "server/accuracy/accuracy.h"
#include "server/accuracy/converged_frames.h"
#include "server/accuracy/picture_file.h"
#include "server/accuracy/bench_run.h"
#include "server/accuracy/edit_latency.h"

#define WARM_UP_FRAMES 2
#define ENOUGH_MS      4000.0
#define STRIP_PICTURES 4u
#define STRIP_GAP      4u

// Work on one configuration.
struct configuration_work {
    const struct accuracy *accuracy;
    const struct configuration *configuration;
    struct frame_params params;
    struct view *view;
    struct picture cold, converged, direct; // of the reference image's size
    float *flip_map;                        // of the converged image
    cJSON *entry;
};

static double rounded(double value, double step)
{
    return round(value / step) * step;
}

static uint32_t scaled_edge(uint32_t edge, double scale)
{
    double scaled = round(edge * scale);
    return scaled < 1.0 ? 1 : (uint32_t)scaled;
}

// Linear interpolation between pixel centres; at half the size this is the mean of 2 x 2 pixels.
static void resample(const struct picture *source, struct picture *target)
{
    float step_x = (float)source->width / (float)target->width;
    float step_y = (float)source->height / (float)target->height;
    for (uint32_t y = 0; y < target->height; y++)
        for (uint32_t x = 0; x < target->width; x++) {
            float at_x = ((float)x + 0.5f) * step_x - 0.5f,
                  at_y = ((float)y + 0.5f) * step_y - 0.5f;
            at_x = fminf(fmaxf(at_x, 0.0f), (float)(source->width - 1));
            at_y = fminf(fmaxf(at_y, 0.0f), (float)(source->height - 1));
            uint32_t x0 = (uint32_t)at_x, y0 = (uint32_t)at_y;
            uint32_t x1 = x0 + 1 < source->width ? x0 + 1 : x0;
            uint32_t y1 = y0 + 1 < source->height ? y0 + 1 : y0;
            float part_x = at_x - (float)x0, part_y = at_y - (float)y0;
            const float *row0 = source->rgb + (size_t)3 * source->width * y0;
            const float *row1 = source->rgb + (size_t)3 * source->width * y1;
            float *out = target->rgb + 3 * ((size_t)y * target->width + x);
            for (uint32_t c = 0; c < 3; c++) {
                float top = row0[3 * x0 + c] + part_x * (row0[3 * x1 + c] - row0[3 * x0 + c]);
                float bottom = row1[3 * x0 + c] + part_x * (row1[3 * x1 + c] - row1[3 * x0 + c]);
                out[c] = top + part_y * (bottom - top);
            }
        }
}

// Converts pixels to an image of the reference image's size.
static bool take_picture(const struct configuration_work *work, const struct frame_pixels *pixels,
                         struct picture *out_picture)
{
    const struct picture *reference_image =
        &work->accuracy->reference_image.pictures[REFERENCE_IMAGE_ALL];
    struct picture picture;
    if (!picture_from_pixels(pixels, &picture))
        return false;
    if (picture.width == reference_image->width && picture.height == reference_image->height) {
        *out_picture = picture;
        return true;
    }
    bool done = picture_init(out_picture, reference_image->width, reference_image->height);
    if (done)
        resample(&picture, out_picture);
    picture_finish(&picture);
    return done;
}

static double sum(const struct samples *samples)
{
    double total = 0.0;
    for (uint32_t i = 0; i < samples->count; i++)
        total += samples->values[i];
    return total;
}

// Measures a moving camera: time of frames and passes, memory. Also compiles the shaders.
static bool measure_frames(struct configuration_work *work, struct error *out_error)
{
    const struct shot *shot = &work->accuracy->shot;
    struct bench_run run = {.renderer = shot->renderer,
                            .scene = shot->scene,
                            .params = work->params,
                            .frames = work->accuracy->frames,
                            .warm_up_frames = WARM_UP_FRAMES,
                            .enough_ms = ENOUGH_MS};
    struct bench_result result;
    run.params.output = FRAME_OUTPUT_YCBCR;
    bool done = bench_measure(&run, &result, out_error);
    if (done) {
        const struct samples *ms = &result.measurement.frame_ms;
        cJSON *entry = work->entry, *frame = cJSON_AddObjectToObject(entry, "frame_ms");
        cJSON_AddNumberToObject(frame, "median", rounded(samples_quantile(ms, 0.5), 1e-3));
        cJSON_AddNumberToObject(frame, "p95", rounded(samples_quantile(ms, 0.95), 1e-3));
        cJSON_AddNumberToObject(frame, "frames", ms->count);
        cJSON *passes = cJSON_AddObjectToObject(entry, "pass_ms");
        for (uint32_t i = 0; i < result.statistics.pass_count; i++)
            if (bench_pass_ms(&result, i) > 0.0)
                cJSON_AddNumberToObject(passes, result.statistics.passes[i].name,
                                        rounded(bench_pass_ms(&result, i), 1e-3));
        cJSON_AddNumberToObject(entry, "memory_bytes", (double)bench_memory_bytes(&result));
    }
    bench_result_finish(&result);
    return done;
}

// Uploads the scene anew, so that no light of it is cached.
static bool forget_light(const struct accuracy *accuracy, struct error *out_error)
{
    return renderer_set_scene(accuracy->shot.renderer, NULL, out_error) &&
           renderer_set_scene(accuracy->shot.renderer, accuracy->shot.scene, out_error);
}

// The first image of a scene that has just been uploaded, and the converged one.
static bool draw_pictures(struct configuration_work *work, struct error *out_error)
{
    struct renderer *renderer = work->accuracy->shot.renderer;
    struct frame_pixels pixels;
    struct measurement measurement = {0};
    work->params.output = FRAME_OUTPUT_LINEAR;
    if (!frames_render(renderer, work->view, &work->params, &pixels, out_error))
        return false;
    double cold_ms = pixels.frame_time_ms;
    bool done = take_picture(work, &pixels, &work->cold);
    renderer_view_release(renderer, work->view);
    struct converged_frames render = {.renderer = renderer,
                                      .view = work->view,
                                      .params = &work->params,
                                      .max_frames = MAX_CONVERGING_FRAMES,
                                      .measurement = &measurement};
    if (!done || !frames_render_converged(&render, out_error)) {
        measurement_finish(&measurement);
        return done || error_set(out_error, "out of memory");
    }
    done = take_picture(work, &render.pixels, &work->converged);
    renderer_view_release(renderer, work->view);
    cJSON *cold = cJSON_AddObjectToObject(work->entry, "cold");
    cJSON_AddNumberToObject(cold, "ms", rounded(cold_ms, 1e-3));
    cJSON *converged = cJSON_AddObjectToObject(work->entry, "converged");
    cJSON_AddNumberToObject(converged, "ms", rounded(cold_ms + sum(&measurement.frame_ms), 1e-3));
    cJSON_AddNumberToObject(converged, "frames", 1 + render.frame_count);
    cJSON_AddBoolToObject(converged, "settled", render.converged);
    measurement_finish(&measurement);
    return done || error_set(out_error, "out of memory");
}

// Direct light alone, with the same settings.
static bool draw_direct(struct configuration_work *work, struct error *out_error)
{
    struct frame_params params = work->params;
    struct converged_frames render = {.renderer = work->accuracy->shot.renderer,
                                      .view = work->view,
                                      .params = &params,
                                      .max_frames = MAX_CONVERGING_FRAMES};
    params.debug_view = DEBUG_VIEW_DIRECT;
    if (!frames_render_converged(&render, out_error))
        return false;
    bool done = take_picture(work, &render.pixels, &work->direct);
    renderer_view_release(render.renderer, render.view);
    return done || error_set(out_error, "out of memory");
}

static bool measure_edits(struct configuration_work *work, struct error *out_error)
{
    const struct accuracy *accuracy = work->accuracy;
    struct edit_params params = {.renderer = accuracy->shot.renderer,
                                 .scene = accuracy->shot.scene,
                                 .view = work->view,
                                 .frame = &work->params,
                                 .light = SCENE_NONE,
                                 .material = SCENE_NONE,
                                 .repetitions = accuracy->edits};
    struct edit_result result;
    if (accuracy->edits == 0)
        return true;
    cJSON *edit = cJSON_AddObjectToObject(work->entry, "edit");
    // A scene may have nothing to edit, and a method may not converge: both are results.
    if (!edit_measure(&params, &result, out_error))
        cJSON_AddStringToObject(edit, "error", out_error->message);
    else
        for (int i = 0; i < EDIT_STAGE_COUNT; i++) {
            char name[32];
            snprintf(name, sizeof(name), "%s_ms", edit_stage_names[i]);
            cJSON_AddNumberToObject(edit, name,
                                    rounded(samples_quantile(&result.ms[i], 0.5), 1e-3));
            snprintf(name, sizeof(name), "%s_frames", edit_stage_names[i]);
            cJSON_AddNumberToObject(edit, name, samples_quantile(&result.frames[i], 0.5));
        }
    edit_result_finish(&result);
    return true;
}

static void add_metrics(cJSON *object, const char *name, const struct image_metrics *metrics)
{
    cJSON *json = cJSON_AddObjectToObject(object, name);
    for (int i = 0; i < METRIC_COUNT; i++)
        cJSON_AddNumberToObject(json, image_metric_infos[i].name, metrics->values[i]);
}

// An image without its direct light, black where surfaces emit.
static bool take_indirect(const struct accuracy *accuracy, const struct picture *picture,
                          const struct picture *direct, struct picture *out_indirect)
{
    size_t count = picture_pixel_count(picture);
    if (!picture_init(out_indirect, picture->width, picture->height))
        return false;
    for (size_t i = 0; i < 3 * count; i++)
        if (!accuracy->self_lit[i / 3])
            out_indirect->rgb[i] = picture->rgb[i] - direct->rgb[i];
    return true;
}

bool accuracy_judge(const struct accuracy *accuracy, const struct picture *picture,
                    const struct picture *direct, cJSON *object, float *flip_map,
                    struct error *out_error)
{
    const struct picture *reference_image = accuracy->reference_image.pictures;
    struct image_metrics metrics;
    if (!image_metrics_compute(picture, &reference_image[REFERENCE_IMAGE_ALL], &accuracy->display,
                               &metrics, flip_map, out_error))
        return false;
    add_metrics(object, "metrics", &metrics);
    if (!reference_image[REFERENCE_IMAGE_DIRECT].rgb)
        return true;
    struct picture ours = {0}, wanted = {0};
    bool done = (take_indirect(accuracy, picture, direct, &ours) &&
                 take_indirect(accuracy, &reference_image[REFERENCE_IMAGE_ALL],
                               &reference_image[REFERENCE_IMAGE_DIRECT], &wanted)) ||
                error_set(out_error, "out of memory");
    done = done &&
           image_metrics_compute(&ours, &wanted, &accuracy->display, &metrics, NULL, out_error);
    if (done)
        add_metrics(object, "indirect", &metrics);
    picture_finish(&ours);
    picture_finish(&wanted);
    return done;
}

static bool judge_picture(struct configuration_work *work, const char *state,
                          const struct picture *picture, struct error *out_error)
{
    return accuracy_judge(work->accuracy, picture, &work->direct,
                          cJSON_GetObjectItemCaseSensitive(work->entry, state), work->flip_map,
                          out_error);
}

// Writes NAME-SUFFIX.png into the folder and records it in the entry.
static bool write_png(struct configuration_work *work, cJSON *pictures, const char *suffix,
                      uint32_t width, uint32_t height, const uint8_t *rgb, struct error *out_error)
{
    char file[CONFIGURATION_NAME_SIZE + 32], path[4096];
    snprintf(file, sizeof(file), "%s-%s.png", work->configuration->name, suffix);
    snprintf(path, sizeof(path), "%s/%s", work->accuracy->folder, file);
    cJSON_AddStringToObject(pictures, suffix, file);
    return picture_file_write_png(path, width, height, rgb, out_error);
}

// Writes the converged image, the heat map, and a strip of reference image, first image, converged
// image and heat map.
static bool write_pictures(struct configuration_work *work, struct error *out_error)
{
    const struct picture *reference_image =
        &work->accuracy->reference_image.pictures[REFERENCE_IMAGE_ALL];
    uint32_t width = reference_image->width, height = reference_image->height;
    uint32_t strip_width = STRIP_PICTURES * width + (STRIP_PICTURES - 1) * STRIP_GAP;
    size_t bytes = 3 * picture_pixel_count(reference_image);
    uint8_t *parts = malloc(STRIP_PICTURES * bytes);
    uint8_t *strip = calloc(3 * (size_t)strip_width, height);
    bool done = parts && strip;
    if (done) {
        cJSON *pictures = cJSON_AddObjectToObject(work->entry, "pictures");
        display_bytes(&work->accuracy->display, reference_image, parts);
        display_bytes(&work->accuracy->display, &work->cold, parts + bytes);
        display_bytes(&work->accuracy->display, &work->converged, parts + 2 * bytes);
        heat_map_colors(work->flip_map, bytes / 3, parts + 3 * bytes);
        for (uint32_t y = 0; y < height; y++)
            for (uint32_t i = 0; i < STRIP_PICTURES; i++)
                memcpy(strip + 3 * ((size_t)y * strip_width + (size_t)i * (width + STRIP_GAP)),
                       parts + i * bytes + 3 * (size_t)y * width, 3 * (size_t)width);
        done =
            write_png(work, pictures, "converged", width, height, parts + 2 * bytes, out_error) &&
            write_png(work, pictures, "error", width, height, parts + 3 * bytes, out_error) &&
            write_png(work, pictures, "strip", strip_width, height, strip, out_error);
    } else {
        error_set(out_error, "out of memory");
    }
    free(parts);
    free(strip);
    return done;
}

static bool measure(struct configuration_work *work, struct error *out_error)
{
    const struct accuracy *accuracy = work->accuracy;
    work->params = accuracy->shot.params;
    if (!configuration_apply(work->configuration, &work->params, out_error))
        return false;
    cJSON_AddStringToObject(work->entry, "method",
                            gi_method_names[work->params.settings.gi_method]);
    work->params.width = scaled_edge(work->params.width, work->configuration->scale);
    work->params.height = scaled_edge(work->params.height, work->configuration->scale);
    work->flip_map =
        malloc(picture_pixel_count(&accuracy->reference_image.pictures[REFERENCE_IMAGE_ALL]) *
               sizeof(float));
    if (!work->flip_map)
        return error_set(out_error, "out of memory");
    if (!forget_light(accuracy, out_error) || !measure_frames(work, out_error) ||
        !forget_light(accuracy, out_error))
        return false;
    work->view = renderer_view_create(accuracy->shot.renderer);
    if (!work->view)
        return error_set(out_error, "out of memory");
    // Edits start from the converged image.
    bool done = draw_pictures(work, out_error) && draw_direct(work, out_error) &&
                measure_edits(work, out_error);
    renderer_view_destroy(accuracy->shot.renderer, &work->view);
    // An interrupted edit looks like one that cannot be measured.
    done = done && (renderer_admit_frame(accuracy->shot.renderer) ||
                    error_set(out_error, "stopped while configuration %s was measured",
                              work->configuration->name));
    return done && judge_picture(work, "cold", &work->cold, out_error) &&
           judge_picture(work, "converged", &work->converged, out_error) &&
           write_pictures(work, out_error);
}

cJSON *accuracy_measure(const struct accuracy *accuracy, const struct configuration *configuration,
                        struct error *out_error)
{
    struct configuration_work work = {
        .accuracy = accuracy, .configuration = configuration, .entry = cJSON_CreateObject()};
    cJSON_AddStringToObject(work.entry, "name", configuration->name);
    cJSON_AddItemToObject(work.entry, "settings", configuration_json(configuration));
    bool done = measure(&work, out_error);
    picture_finish(&work.cold);
    picture_finish(&work.converged);
    picture_finish(&work.direct);
    free(work.flip_map);
    if (!done) {
        cJSON_Delete(work.entry);
        work.entry = NULL;
    }
    return work.entry;
}
