// The picture that rungs are compared with: from a file, or traced and kept for the next run.
#include <cjson/cJSON.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/accuracy.h"
#include "server/cli_bench.h"

#define TRUTH_SEED       1u
#define SAMPLES_AT_ONCE  16u
#define SECONDS_PER_NEWS 10.0
// Light of the sky is gathered by cones, so that it is indirect light here.
#define LAMP_LAYERS  (REFERENCE_LAYER(REFERENCE_EMISSION) | REFERENCE_LAYER(REFERENCE_DIRECT))
#define MOST_SAMPLES (1u << 20)

// What has been traced, as reference.json has it: equal text means an equal picture.
static char *describe(const struct truth_params *params)
{
    cJSON *json = cJSON_CreateObject();
    cJSON_AddItemToObject(json, "scene", cJSON_Duplicate(params->identity, true));
    cJSON_AddNumberToObject(json, "samples", params->samples);
    cJSON_AddNumberToObject(json, "until_noise", params->until_noise);
    cJSON_AddNumberToObject(json, "seed", TRUTH_SEED);
    char *text = cJSON_PrintUnformatted(json);
    cJSON_Delete(json);
    return text;
}

static bool check_size(const struct truth_params *params, const char *path,
                       const struct picture *picture, struct error *out_error)
{
    const struct frame_params *frame = &params->shot->params;
    return (picture->width == frame->width && picture->height == frame->height) ||
           error_set(out_error, "\"%s\" is of %ux%u, but --size is %ux%u", path, picture->width,
                     picture->height, frame->width, frame->height);
}

static bool load_picture(const struct truth_params *params, const char *path,
                         struct picture *out_picture, struct error *out_error)
{
    return picture_read_pfm(path, out_picture, out_error) &&
           check_size(params, path, out_picture, out_error);
}

// Names of the kept files.
struct kept_paths {
    char picture[4096], direct[4096], description[4096];
};

static void name_files(const char *folder, struct kept_paths *out_paths)
{
    snprintf(out_paths->picture, sizeof(out_paths->picture), "%s/reference.pfm", folder);
    snprintf(out_paths->direct, sizeof(out_paths->direct), "%s/reference-direct.pfm", folder);
    snprintf(out_paths->description, sizeof(out_paths->description), "%s/reference.json", folder);
}

// The picture that an earlier run has kept, if it is the same.
static bool load_kept(const struct truth_params *params, const struct kept_paths *paths,
                      const char *description, struct truth *out_truth)
{
    struct error ignored;
    char *text = calloc(1, strlen(description) + 64);
    FILE *file = fopen(paths->description, "rb");
    bool done = false;
    if (text && file) {
        size_t length = fread(text, 1, strlen(description) + 63, file);
        char *noise = length > 0 ? strchr(text, '\n') : NULL;
        if (noise) {
            *noise = '\0';
            out_truth->noise = strtod(noise + 1, NULL);
            done = strcmp(text, description) == 0;
        }
    }
    if (file)
        fclose(file);
    free(text);
    done = done && load_picture(params, paths->picture, &out_truth->picture, &ignored) &&
           load_picture(params, paths->direct, &out_truth->direct, &ignored);
    if (!done)
        truth_finish(out_truth);
    return done;
}

static bool keep(const struct kept_paths *paths, const char *description, const struct truth *truth,
                 struct error *out_error)
{
    if (!picture_write_pfm(paths->picture, &truth->picture, out_error) ||
        !picture_write_pfm(paths->direct, &truth->direct, out_error))
        return false;
    FILE *file = fopen(paths->description, "wb");
    bool done = file && fprintf(file, "%s\n%.17g\n", description, truth->noise) > 0;
    if (file)
        done = fclose(file) == 0 && done;
    return done || error_set(out_error, "cannot write \"%s\"", paths->description);
}

static bool take_layers(struct reference *reference, uint32_t layers, struct picture *out_picture)
{
    size_t count = picture_pixel_count(out_picture);
    float *rgba = malloc(4 * count * sizeof(float));
    if (!rgba)
        return false;
    reference_get_picture(reference, layers, rgba);
    for (size_t i = 0; i < count; i++)
        memcpy(out_picture->rgb + 3 * i, rgba + 4 * i, 3 * sizeof(float));
    free(rgba);
    return true;
}

// Traces until there are enough samples, or the noise is low enough.
static void trace(const struct truth_params *params, struct reference *reference,
                  struct reference_progress *out_progress)
{
    uint32_t wanted = params->until_noise > 0.0 ? MOST_SAMPLES : params->samples;
    double last_news = 0.0, started = 1e-3 * bench_now_ms();
    *out_progress = (struct reference_progress){.noise = INFINITY};
    while (out_progress->samples < wanted && !(out_progress->noise <= params->until_noise)) {
        uint32_t missing = wanted - out_progress->samples;
        reference_render(reference, missing < SAMPLES_AT_ONCE ? missing : SAMPLES_AT_ONCE);
        reference_get_progress(reference, out_progress);
        double elapsed = 1e-3 * bench_now_ms() - started;
        if (elapsed - last_news < SECONDS_PER_NEWS)
            continue;
        last_news = elapsed;
        // Noise falls with the square root of the samples.
        double ratio = out_progress->noise / params->until_noise;
        double left = params->until_noise > 0.0
                          ? elapsed * fmax(ratio * ratio - 1.0, 0.0)
                          : elapsed * (wanted - out_progress->samples) / out_progress->samples;
        fprintf(stderr,
                "voxcast: reference: %u samples a pixel, noise %.2f %%, about %.0f s left\n",
                out_progress->samples, 100.0 * out_progress->noise, left);
    }
}

static bool trace_truth(const struct truth_params *params, struct truth *truth,
                        struct error *out_error)
{
    const struct frame_params *frame = &params->shot->params;
    struct reference_progress progress;
    struct snapshot *snapshot = snapshot_create(
        params->shot->scene, frame->settings.shading_model == SHADING_MODEL_BLINN_PHONG, out_error);
    if (!snapshot)
        return false;
    struct reference *reference =
        reference_create(&(struct reference_params){.scene = snapshot,
                                                    .camera = frame->camera,
                                                    .width = frame->width,
                                                    .height = frame->height,
                                                    .max_bounces = REFERENCE_UNLIMITED,
                                                    .seed = TRUTH_SEED},
                         out_error);
    snapshot_release(&snapshot);
    if (!reference)
        return false;
    trace(params, reference, &progress);
    truth->noise = progress.noise;
    fprintf(stderr, "voxcast: reference: %u samples a pixel, noise %.2f %%\n", progress.samples,
            100.0 * progress.noise);
    bool done = picture_init(&truth->picture, frame->width, frame->height) &&
                picture_init(&truth->direct, frame->width, frame->height) &&
                take_layers(reference, REFERENCE_ALL_LAYERS, &truth->picture) &&
                take_layers(reference, LAMP_LAYERS, &truth->direct);
    reference_destroy(&reference);
    return done || error_set(out_error, "out of memory");
}

static bool load_given(const struct truth_params *params, struct truth *truth,
                       struct error *out_error)
{
    return load_picture(params, params->path, &truth->picture, out_error) &&
           (!params->direct_path ||
            load_picture(params, params->direct_path, &truth->direct, out_error));
}

bool truth_get(const struct truth_params *params, struct truth *out_truth, struct error *out_error)
{
    struct kept_paths paths;
    *out_truth = (struct truth){.noise = NAN};
    if (params->path) {
        if (load_given(params, out_truth, out_error))
            return true;
        truth_finish(out_truth);
        return false;
    }
    char *description = describe(params);
    if (!description)
        return error_set(out_error, "out of memory");
    name_files(params->folder, &paths);
    bool done = load_kept(params, &paths, description, out_truth);
    if (done)
        fprintf(stderr, "voxcast: reference: kept from an earlier run, noise %.2f %%\n",
                100.0 * out_truth->noise);
    else
        done = trace_truth(params, out_truth, out_error) &&
               keep(&paths, description, out_truth, out_error);
    free(description);
    if (!done)
        truth_finish(out_truth);
    return done;
}

void truth_finish(struct truth *truth)
{
    picture_finish(&truth->picture);
    picture_finish(&truth->direct);
}
