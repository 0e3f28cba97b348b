// The image that configurations are compared with: loaded from a file, or traced and kept for the
// next run.
#include <cjson/cJSON.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "renderer/clock.h"
#include "server/accuracy/accuracy.h"
#include "server/accuracy/bench_run.h"

#define FIRST_SEED       1u
#define SAMPLES_AT_ONCE  8u
#define PATH_SIZE        4096u
#define SECONDS_PER_NEWS 0.5
// Cones gather the sky's light, so it counts as indirect light here.
#define LIGHT_LAYERS (REFERENCE_LAYER(REFERENCE_EMISSION) | REFERENCE_LAYER(REFERENCE_DIRECT))
#define MAX_SAMPLES  (1u << 20)

// What was traced, as reference.json has it: equal text means an equal image.
static char *describe(const struct reference_image_params *params)
{
    cJSON *json = cJSON_CreateObject();
    cJSON_AddItemToObject(json, "scene", cJSON_Duplicate(params->identity, true));
    cJSON_AddNumberToObject(json, "samples", params->samples);
    cJSON_AddNumberToObject(json, "until_noise", params->until_noise);
    cJSON_AddNumberToObject(json, "most_s", params->max_s);
    cJSON_AddNumberToObject(json, "seed", FIRST_SEED);
    char *text = cJSON_PrintUnformatted(json);
    cJSON_Delete(json);
    return text;
}

static bool check_size(const struct reference_image_params *params, const char *path,
                       const struct picture *picture, struct error *out_error)
{
    const struct frame_params *frame = &params->shot->params;
    return (picture->width == frame->width && picture->height == frame->height) ||
           error_set(out_error, "\"%s\" is of %ux%u, but --size is %ux%u", path, picture->width,
                     picture->height, frame->width, frame->height);
}

static bool load_picture(const struct reference_image_params *params, const char *path,
                         struct picture *out_picture, struct error *out_error)
{
    return picture_read_pfm(path, out_picture, out_error) &&
           check_size(params, path, out_picture, out_error);
}

static const char *const kept_names[REFERENCE_IMAGE_PICTURE_COUNT] = {
    "reference.pfm", "reference-direct.pfm", "reference-half.pfm", "reference-half-direct.pfm"};

static void name_file(const struct reference_image_params *params, const char *name,
                      char out_path[PATH_SIZE])
{
    snprintf(out_path, PATH_SIZE, "%s/%s", params->folder, name);
}

// Loads the images that an earlier run has kept, if they are the same ones.
static bool load_kept(const struct reference_image_params *params, const char *description,
                      struct reference_image *out_reference)
{
    struct error ignored;
    char path[PATH_SIZE], *text = calloc(1, strlen(description) + 64);
    name_file(params, "reference.json", path);
    FILE *file = fopen(path, "rb");
    bool done = false;
    if (text && file) {
        size_t length = fread(text, 1, strlen(description) + 63, file);
        char *noise = length > 0 ? strchr(text, '\n') : NULL;
        if (noise) {
            *noise = '\0';
            out_reference->noise = strtod(noise + 1, NULL);
            done = strcmp(text, description) == 0;
        }
    }
    if (file)
        fclose(file);
    free(text);
    for (int i = 0; i < REFERENCE_IMAGE_PICTURE_COUNT && done; i++) {
        name_file(params, kept_names[i], path);
        done = load_picture(params, path, &out_reference->pictures[i], &ignored);
    }
    if (!done)
        reference_image_finish(out_reference);
    return done;
}

static bool keep(const struct reference_image_params *params, const char *description,
                 const struct reference_image *reference_image, struct error *out_error)
{
    char path[PATH_SIZE];
    for (int i = 0; i < REFERENCE_IMAGE_PICTURE_COUNT; i++) {
        name_file(params, kept_names[i], path);
        if (!picture_write_pfm(path, &reference_image->pictures[i], out_error))
            return false;
    }
    name_file(params, "reference.json", path);
    FILE *file = fopen(path, "wb");
    bool done = file && fprintf(file, "%s\n%.17g\n", description, reference_image->noise) > 0;
    if (file)
        done = fclose(file) == 0 && done;
    return done || error_set(out_error, "cannot write \"%s\"", path);
}

// Adds a fraction of the light of some layers.
static bool add_layers(struct reference *reference, uint32_t layers, float fraction,
                       struct picture *picture)
{
    size_t count = picture_pixel_count(picture);
    float *rgba = malloc(4 * count * sizeof(float));
    if (!rgba)
        return false;
    reference_get_picture(reference, layers, rgba);
    for (size_t i = 0; i < 3 * count; i++)
        picture->rgb[i] += fraction * rgba[i / 3 * 4 + i % 3];
    free(rgba);
    return true;
}

// Both halves of the samples: two references with random numbers of their own.
struct halves {
    struct reference *references[2];
};

static void get_progress(const struct halves *halves, uint32_t *out_samples, double *out_noise)
{
    struct reference_progress progress[2];
    for (int i = 0; i < 2; i++)
        reference_get_progress(halves->references[i], &progress[i]);
    *out_samples = progress[0].samples + progress[1].samples;
    *out_noise = 0.5 * hypot(progress[0].noise, progress[1].noise);
}

// What is known while the reference image is being traced.
struct trace_state {
    const struct reference_image_params *params;
    const struct halves *halves;
    double started_ms;
    uint32_t samples;
    double noise;
};

static bool until_noise(const struct reference_image_params *params)
{
    return params->until_noise > 0.0;
}

static double elapsed_s(const struct trace_state *state)
{
    return 1e-3 * (clock_now_ms() - state->started_ms);
}

// Noise falls with the square root of the samples.
static double seconds_left(const struct trace_state *state, uint32_t wanted)
{
    double max_s = state->params->max_s, left_s = NAN;
    double ratio = state->noise / state->params->until_noise;
    if (until_noise(state->params) && isfinite(state->noise))
        left_s = elapsed_s(state) * fmax(ratio * ratio - 1.0, 0.0);
    if (!until_noise(state->params) && state->samples > 0)
        left_s = elapsed_s(state) * (double)(wanted - state->samples) / state->samples;
    return max_s > 0.0 ? fmin(left_s, fmax(max_s - elapsed_s(state), 0.0)) : left_s;
}

static bool is_enough(const struct trace_state *state, uint32_t wanted)
{
    double max_s = state->params->max_s;
    return state->samples >= wanted || state->noise <= state->params->until_noise ||
           (max_s > 0.0 && state->samples > 0 && elapsed_s(state) >= max_s);
}

static bool tell(const struct trace_state *state, enum accuracy_stage stage, double left_s)
{
    const struct accuracy_watch *watch = &state->params->watch;
    return !watch->tell || watch->tell(watch->user, &(struct accuracy_progress){
                                                        .stage = stage,
                                                        .samples = state->samples,
                                                        .noise = state->noise,
                                                        .left_s = left_s,
                                                    });
}

// Adds samples to one half. False if the watch ends the run.
static bool add_samples(struct trace_state *state, struct reference *half, uint32_t count,
                        uint32_t wanted)
{
    reference_start(half, reference_get_samples(half) + count);
    while (!reference_wait(half, SECONDS_PER_NEWS)) {
        get_progress(state->halves, &state->samples, &state->noise);
        if (!tell(state, ACCURACY_TRACING, seconds_left(state, wanted))) {
            reference_stop(half);
            return false;
        }
    }
    return true;
}

// Traces until there are enough samples, the noise is low enough, or time is up. False if the watch
// ends the run.
static bool trace(const struct reference_image_params *params, const struct halves *halves,
                  double *out_noise)
{
    uint32_t wanted = until_noise(params) ? MAX_SAMPLES : params->samples;
    struct trace_state state = {
        .params = params, .halves = halves, .started_ms = clock_now_ms(), .noise = INFINITY};
    double told_ms = state.started_ms;
    while (!is_enough(&state, wanted)) {
        uint32_t missing = (wanted - state.samples + 1) / 2;
        uint32_t count = missing < SAMPLES_AT_ONCE ? missing : SAMPLES_AT_ONCE;
        for (int i = 0; i < 2; i++)
            if (!add_samples(&state, halves->references[i], count, wanted))
                return false;
        get_progress(halves, &state.samples, &state.noise);
        if (clock_now_ms() - told_ms < 1e3 * SECONDS_PER_NEWS)
            continue;
        told_ms = clock_now_ms();
        if (!tell(&state, ACCURACY_TRACING, seconds_left(&state, wanted)))
            return false;
    }
    *out_noise = state.noise;
    return tell(&state, ACCURACY_TRACED, 0.0);
}

static bool take_pictures(const struct halves *halves, const struct frame_params *frame,
                          struct reference_image *reference_image)
{
    for (int i = 0; i < REFERENCE_IMAGE_PICTURE_COUNT; i++) {
        struct picture *picture = &reference_image->pictures[i];
        bool whole = i < REFERENCE_IMAGE_HALF;
        uint32_t layers = i == REFERENCE_IMAGE_DIRECT || i == REFERENCE_IMAGE_HALF_DIRECT
                              ? LIGHT_LAYERS
                              : REFERENCE_ALL_LAYERS;
        if (!picture_init(picture, frame->width, frame->height) ||
            !add_layers(halves->references[0], layers, whole ? 0.5f : 1.0f, picture) ||
            (whole && !add_layers(halves->references[1], layers, 0.5f, picture)))
            return false;
    }
    return true;
}

static bool trace_reference(const struct reference_image_params *params,
                            struct reference_image *reference_image, struct error *out_error)
{
    const struct frame_params *frame = &params->shot->params;
    struct halves halves = {{NULL, NULL}};
    struct reference_params reference = {
        .scene =
            snapshot_copy(params->shot->scene,
                          frame->settings.shading_model == SHADING_MODEL_BLINN_PHONG, out_error),
        .low_priority = params->low_priority,
        .camera = frame->camera,
        .width = frame->width,
        .height = frame->height,
        .max_bounces = REFERENCE_UNLIMITED};
    bool done = reference.scene && snapshot_build(reference.scene, params->low_priority, out_error);
    for (int i = 0; i < 2 && done; i++) {
        reference.seed = FIRST_SEED + (uint64_t)i;
        halves.references[i] = reference_create(&reference, out_error);
        done = halves.references[i] != NULL;
    }
    if (reference.scene)
        snapshot_release(&reference.scene);
    done = done && (trace(params, &halves, &reference_image->noise) ||
                    error_set(out_error, "stopped while the reference was traced"));
    done = done && (take_pictures(&halves, frame, reference_image) ||
                    error_set(out_error, "out of memory"));
    for (int i = 0; i < 2; i++)
        if (halves.references[i])
            reference_destroy(&halves.references[i]);
    return done;
}

static bool load_given(const struct reference_image_params *params,
                       struct reference_image *reference_image, struct error *out_error)
{
    return load_picture(params, params->path, &reference_image->pictures[REFERENCE_IMAGE_ALL],
                        out_error) &&
           (!params->direct_path ||
            load_picture(params, params->direct_path,
                         &reference_image->pictures[REFERENCE_IMAGE_DIRECT], out_error));
}

// As trace_reference(), but reuses the images of an earlier run.
static bool find_or_trace(const struct reference_image_params *params,
                          struct reference_image *reference_image, struct error *out_error)
{
    char *description = describe(params);
    if (!description)
        return error_set(out_error, "out of memory");
    bool done = load_kept(params, description, reference_image);
    if (done) {
        struct trace_state state = {.params = params, .noise = reference_image->noise};
        done = tell(&state, ACCURACY_TRACED, 0.0) ||
               error_set(out_error, "stopped after the reference was loaded");
    } else {
        done = trace_reference(params, reference_image, out_error) &&
               keep(params, description, reference_image, out_error);
    }
    free(description);
    return done;
}

bool reference_image_get(const struct reference_image_params *params,
                         struct reference_image *out_reference, struct error *out_error)
{
    *out_reference = (struct reference_image){.noise = NAN};
    if (params->path) {
        if (load_given(params, out_reference, out_error))
            return true;
        reference_image_finish(out_reference);
        return false;
    }
    bool done = params->folder ? find_or_trace(params, out_reference, out_error)
                               : trace_reference(params, out_reference, out_error);
    if (!done)
        reference_image_finish(out_reference);
    return done;
}

void reference_image_finish(struct reference_image *reference_image)
{
    for (int i = 0; i < REFERENCE_IMAGE_PICTURE_COUNT; i++)
        picture_finish(&reference_image->pictures[i]);
}
