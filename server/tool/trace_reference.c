#include "server/tool/trace_reference.h"

#include <cjson/cJSON.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "renderer/metrics/display.h"
#include "renderer/metrics/picture.h"
#include "server/accuracy/picture_file.h"
#include "server/tool/cli.h"
#include "renderer/clock.h"

#define DEFAULT_SAMPLES 64u
// The noise is estimated each time that the samples have grown by this factor.
#define NOISE_STEP 1.25

static const char *const light_names[CLI_LIGHT_COUNT] = {"all", "direct", "indirect"};
static const char *const estimator_names[] = {"both", "lights", "surfaces"};

void cli_take_reference(struct cli_parser *parser, struct cli_reference_options *target)
{
    *target = (struct cli_reference_options){.bounces = REFERENCE_UNLIMITED};
    cli_take_count(parser, "spp", 1, REFERENCE_MAX_SAMPLES, &target->samples);
    cli_take_number(parser, "time", 0.001, 1e7, &target->time_s);
    cli_take_number(parser, "noise", 1e-6, 1.0, &target->noise);
    cli_take_count(parser, "bounces", 0, 1000, &target->bounces);
    cli_take_count(parser, "bounce", 1, REFERENCE_MAX_BOUNCE_PICTURES - 1, &target->bounce);
    cli_take_choice(parser, "light", light_names, CLI_LIGHT_COUNT, &target->light);
    cli_take_choice(parser, "estimator", estimator_names, 3, &target->estimator);
    cli_take_count(parser, "seed", 0, UINT32_MAX, &target->seed);
    cli_take_count(parser, "threads", 1, REFERENCE_MAX_THREADS, &target->threads);
}

bool cli_write_json(const char *path, const struct cJSON *json, struct error *out_error)
{
    char *text = cJSON_Print(json);
    FILE *file = text ? fopen(path, "wb") : NULL;
    bool done = file && fputs(text, file) >= 0 && fputc('\n', file) != EOF;
    if (file)
        done = fclose(file) == 0 && done;
    cJSON_free(text);
    return done || error_set(out_error, "cannot write \"%s\"", path);
}

static uint32_t layers_of(const struct cli_reference_options *options)
{
    if (options->bounce > 0)
        return REFERENCE_LAYER(REFERENCE_FIRST_BOUNCE + options->bounce - 1);
    static const uint32_t layers[] = {REFERENCE_ALL_LAYERS, REFERENCE_DIRECT_LAYERS,
                                      REFERENCE_INDIRECT_LAYERS};
    return layers[options->light];
}

// Adds samples until there are enough, the noise is low enough, or time is over.
static void add_samples(const struct cli_reference_options *options, struct reference *reference,
                        struct reference_progress *out_progress)
{
    bool open_ended = options->time_s > 0.0 || options->noise > 0.0;
    uint32_t maximum = options->samples ? options->samples
                       : open_ended     ? REFERENCE_MAX_SAMPLES
                                        : DEFAULT_SAMPLES;
    double end_s = options->time_s > 0.0 ? 1e-3 * clock_now_ms() + options->time_s : INFINITY;
    uint32_t target = options->noise > 0.0 ? (maximum < 16 ? maximum : 16) : maximum;
    for (;;) {
        reference_start(reference, target);
        bool reached = reference_wait(reference, end_s - 1e-3 * clock_now_ms());
        if (!reached)
            reference_stop(reference);
        reference_get_progress(reference, out_progress);
        if (!reached || target == maximum || out_progress->noise < options->noise)
            return;
        double more = target * NOISE_STEP + 1.0;
        target = more < maximum ? (uint32_t)more : maximum;
    }
}

// The displayed image, as the settings have it.
static bool write_displayed(const char *path, const struct picture *picture,
                            const struct render_settings *settings, struct error *out_error)
{
    float scale = exp2f(settings->exposure_ev);
    struct display_params display = {
        .exposure = scale, .tonemap = settings->tonemap, .gamma = settings->gamma};
    if (settings->exposure_mode == EXPOSURE_AUTOMATIC)
        display.exposure = scale * display_automatic_exposure(picture);
    size_t count = picture_pixel_count(picture);
    uint8_t *rgba = malloc(count * 4);
    if (!rgba)
        return error_set(out_error, "out of memory");
    for (size_t i = 0; i < count; i++) {
        float shown[3];
        display_pixel(&display, picture->rgb + 3 * i, shown);
        for (size_t c = 0; c < 3; c++)
            rgba[4 * i + c] = (uint8_t)(shown[c] * 255.0f + 0.5f);
        rgba[4 * i + 3] = 255;
    }
    struct frame_pixels pixels = {.width = picture->width,
                                  .height = picture->height,
                                  .output = FRAME_OUTPUT_RGBA8,
                                  .planes = {rgba},
                                  .row_pitch_bytes = {picture->width * 4}};
    bool done = picture_file_write(path, &pixels, out_error);
    free(rgba);
    return done;
}

static bool write_picture(const struct cli_reference_options *options, const struct shot *shot,
                          struct reference *reference, const char *path, struct error *out_error)
{
    struct picture picture;
    size_t count = (size_t)shot->params.width * shot->params.height;
    float *rgba = malloc(count * 4 * sizeof(float));
    if (!rgba || !picture_init(&picture, shot->params.width, shot->params.height)) {
        free(rgba);
        return error_set(out_error, "out of memory");
    }
    reference_get_picture(reference, layers_of(options), rgba);
    for (size_t i = 0; i < 3 * count; i++)
        picture.rgb[i] = rgba[i / 3 * 4 + i % 3];
    free(rgba);
    enum frame_output output = FRAME_OUTPUT_LINEAR;
    picture_file_output(path, &output);
    bool done = output == FRAME_OUTPUT_LINEAR
                    ? picture_write_pfm(path, &picture, out_error)
                    : write_displayed(path, &picture, &shot->params.settings, out_error);
    picture_finish(&picture);
    return done;
}

static bool write_statistics(const char *path, const struct shot *shot,
                             const struct reference_progress *progress, double seconds,
                             struct error *out_error)
{
    cJSON *json = cJSON_CreateObject();
    cJSON *size = cJSON_AddArrayToObject(json, "size");
    cJSON_AddItemToArray(size, cJSON_CreateNumber(shot->params.width));
    cJSON_AddItemToArray(size, cJSON_CreateNumber(shot->params.height));
    cJSON_AddStringToObject(json, "gi_method", gi_method_names[GI_METHOD_REFERENCE]);
    cJSON_AddNumberToObject(json, "samples", progress->samples);
    cJSON_AddNumberToObject(json, "noise", isfinite(progress->noise) ? progress->noise : -1.0);
    cJSON_AddNumberToObject(json, "mean_luminance", progress->mean_luminance);
    cJSON_AddNumberToObject(json, "nearest_rays", (double)progress->nearest_rays);
    cJSON_AddNumberToObject(json, "shadow_rays", (double)progress->shadow_rays);
    cJSON_AddNumberToObject(json, "seconds", seconds);
    bool done = cli_write_json(path, json, out_error);
    cJSON_Delete(json);
    return done;
}

static uint32_t max_bounces(const struct cli_reference_options *options,
                            const struct render_settings *settings)
{
    if (options->bounces != REFERENCE_UNLIMITED)
        return options->bounces;
    return settings->bounces > 0 ? settings->bounces : REFERENCE_UNLIMITED;
}

int cli_render_reference(const struct cli_reference_options *options, const struct shot *shot,
                         const char *out, const char *stats)
{
    struct error error = {""};
    const struct render_settings *settings = &shot->params.settings;
    struct reference_params params = {
        .scene = snapshot_create(shot->scene, settings->shading_model == SHADING_MODEL_BLINN_PHONG,
                                 &error),
        .camera = shot->params.camera,
        .width = shot->params.width,
        .height = shot->params.height,
        .max_bounces = max_bounces(options, settings),
        .bounce_pictures = options->bounce + 1,
        .seed = options->seed,
        .estimator = (enum reference_estimator)options->estimator,
        .threads = options->threads,
    };
    struct reference *reference = params.scene ? reference_create(&params, &error) : NULL;
    if (params.scene)
        snapshot_release(&params.scene);
    if (!reference)
        return cli_fail(CLI_EXIT_RENDER, "%s", error.message);
    struct reference_progress progress;
    double started_s = 1e-3 * clock_now_ms();
    add_samples(options, reference, &progress);
    double seconds = 1e-3 * clock_now_ms() - started_s;
    bool done = write_picture(options, shot, reference, out, &error) &&
                (!stats || write_statistics(stats, shot, &progress, seconds, &error));
    reference_destroy(&reference);
    if (!done)
        return cli_fail(CLI_EXIT_OUTPUT, "%s", error.message);
    if (progress.samples == 0)
        fprintf(stderr, "voxcast: warning: there was no time for a sample of every pixel\n");
    return 0;
}
