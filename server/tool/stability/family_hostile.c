// Hostile files, messages and edits. Counts how many broke something: were accepted though they are
// wrong, were refused without a reason, or left a document that violates scene.h.
#include <assert.h>
#include <cjson/cJSON.h>
#include <glob.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "protocol/command.h"
#include "renderer/clock.h"
#include "renderer/image/file_access.h"
#include "renderer/image/environment_image.h"
#include "renderer/import/importers.h"
#include "server/tool/stability/hostile.h"
#include "server/tool/stability/mutation.h"
#include "server/tool/stability/scene_check.h"
#include "server/tool/stability/stability.h"
#include "voxcast_paths.h"

#define FILE_MUTATIONS    10000u
#define MESSAGE_MUTATIONS 20000u
#define MAX_FILE_BYTES    (1u << 16)
// The fuzzers start from them, too.
#define CORPUS VOXCAST_SOURCE_DIR "/tests/fuzz/corpus/"
// An import that takes longer counts as hanging.
#define MAX_IMPORT_MS 10000.0

struct source {
    uint8_t *bytes; // owned
    size_t size;
};

// Reads a file of the corpus.
static bool read_source(struct stability_run *run, const char *name, struct source *out_source)
{
    char path[1024];
    struct error error = {""};
    snprintf(path, sizeof(path), CORPUS "%s", name);
    if (asset_read_file(path, MAX_FILE_BYTES, &out_source->bytes, &out_source->size, NULL, &error))
        return true;
    stability_fail(run, "%s", error.message);
    return false;
}

// Mutations prove most where some are accepted and some are not.
static void check_fraction(struct stability_run *run, const char *name, uint32_t taken,
                           uint32_t count)
{
    if (taken < count / 200 || taken > count - count / 200)
        stability_fail(run, "%s: %u of %u mutations are taken", name, taken, count);
}

// What an import broke; NULL for nothing.
static const char *try_import(const struct importer *importer, const uint8_t *bytes, size_t size,
                              uint32_t *taken_count)
{
    // A block of its own, so that sanitizers see reads beyond it.
    uint8_t *copy = malloc(size);
    if (!copy)
        return "out of memory";
    memcpy(copy, bytes, size);
    struct error error = {""};
    double from_ms = clock_now_ms();
    struct scene *scene = importer->memory(copy, size, NULL, &error);
    double took_ms = clock_now_ms() - from_ms;
    const char *broken = NULL;
    if (scene) {
        for (uint32_t i = 0; i < scene->animation_count; i++)
            scene_animate(scene, i, 0.5f * scene->animations[i].duration_s);
        broken = scene_check(scene);
        (*taken_count)++;
    } else if (strlen(error.message) < 10) {
        broken = "refused without a reason";
    }
    scene_destroy(&scene);
    free(copy);
    return took_ms > MAX_IMPORT_MS ? "takes too long" : broken;
}

// What the decoder of environment images broke; NULL for nothing.
static const char *try_environment(const uint8_t *bytes, size_t size, uint32_t *taken_count)
{
    uint8_t *copy = malloc(size + 1);
    if (!copy)
        return "out of memory";
    memcpy(copy, bytes, size);
    struct error error = {""};
    double from_ms = clock_now_ms();
    struct environment_image *image = environment_image_decode(copy, size, &error);
    double took_ms = clock_now_ms() - from_ms;
    const char *broken = image || strlen(error.message) >= 10 ? NULL : "refused without a reason";
    for (size_t i = 0; image && i < (size_t)image->width * image->height * 3; i++)
        if (!(image->pixels[i] >= 0.0f && image->pixels[i] <= ENVIRONMENT_MAX_RADIANCE))
            broken = "a texel that is no radiance was taken";
    *taken_count += image != NULL;
    environment_image_release(&image);
    free(copy);
    return took_ms > MAX_IMPORT_MS ? "takes too long" : broken;
}

// With an importer of scenes, or NULL for an environment.
static void mutate_file(struct stability_run *run, const char *name,
                        const struct importer *importer, uint32_t *broken_count)
{
    struct source source;
    uint8_t *mutated = malloc(2 * MAX_FILE_BYTES);
    if (!mutated || !read_source(run, name, &source)) {
        free(mutated);
        return;
    }
    uint32_t taken_count = 0;
    for (uint32_t i = 0; i < FILE_MUTATIONS; i++) {
        struct random_numbers random = {i};
        size_t size = mutate(&random, source.bytes, source.size, mutated, 2 * source.size);
        const char *broken = importer ? try_import(importer, mutated, size, &taken_count)
                                      : try_environment(mutated, size, &taken_count);
        *broken_count += broken != NULL;
        stability_measure(run, *broken_count, "%s, mutation %u: %s", name, i,
                          broken ? broken : "good");
    }
    check_fraction(run, name, taken_count, FILE_MUTATIONS);
    free(source.bytes);
    free(mutated);
}

static void run_files(struct stability_run *run)
{
    uint32_t broken = 0;
    for (uint32_t i = 0; importer_at(i); i++) {
        const struct importer *importer = importer_at(i);
        char pattern[1024];
        glob_t found;
        snprintf(pattern, sizeof(pattern), CORPUS "*/*%s", importer->extension);
        if (glob(pattern, 0, NULL, &found) != 0) {
            stability_fail(run, "there is no %s", pattern);
            continue;
        }
        for (size_t j = 0; j < found.gl_pathc; j++)
            mutate_file(run, found.gl_pathv[j] + strlen(CORPUS), importer, &broken);
        globfree(&found);
    }
}

static void run_environments(struct stability_run *run)
{
    static const char *const names[] = {"half.exr", "tiles.exr", "rle.exr",  "zip.exr", "piz.exr",
                                        "b44.exr",  "pxr24.exr", "flat.hdr", "rle.hdr"};
    uint32_t broken = 0;
    for (size_t i = 0; i < sizeof(names) / sizeof(names[0]); i++) {
        char path[64];
        snprintf(path, sizeof(path), "environment/%s", names[i]);
        mutate_file(run, path, NULL, &broken);
    }
}

static bool is_in_range(const struct parameter_value *value)
{
    const struct parameter *parameter = value->parameter;
    uint32_t count = parameter_component_count(parameter->type);
    double low = parameter->min, high = parameter->max;
    if (parameter->type == PARAMETER_BOOL)
        high = 1.0;
    if (parameter->type == PARAMETER_ENUM)
        high = parameter_value_count(parameter) - 1.0;
    for (uint32_t i = 0; i < count; i++)
        if (!(value->numbers[i] >= low && value->numbers[i] <= high))
            return false;
    return memchr(value->text, '\0', sizeof(value->text)) != NULL;
}

// What a message broke; NULL for nothing. `out_taken` says whether it is a command.
static const char *try_message(const char *text, size_t size, struct command *command,
                               bool *out_taken)
{
    struct rpc_request request;
    struct rpc_error error = {0};
    assert(command);
    *out_taken = false;
    bool parsed = rpc_request_parse(text, size, &request, &error);
    if (parsed) {
        *out_taken = command_parse(&request, command, &error);
        rpc_request_finish(&request);
    }
    if (!*out_taken)
        return error.code && error.message[0] ? NULL : "refused without a reason";
    if (command->value_count > COMMAND_MAX_VALUES)
        return "too many values";
    for (uint32_t i = 0; i < command->value_count; i++)
        if (!is_in_range(&command->values[i]))
            return "a value beyond its range was taken";
    return NULL;
}

static void run_messages(struct stability_run *run)
{
    static const char *const names[] = {
        "accuracy", "ack",          "camera",      "hello", "load",
        "pick",     "light_update", "node_update", "view",  "material_update"};
    uint32_t broken_count = 0;
    struct command *command = malloc(sizeof(*command));
    char *mutated = malloc(2 * MAX_FILE_BYTES);
    for (size_t n = 0; command && mutated && n < sizeof(names) / sizeof(names[0]); n++) {
        char name[64];
        struct source source;
        snprintf(name, sizeof(name), "protocol/%s.json", names[n]);
        if (!read_source(run, name, &source))
            break;
        uint32_t taken_count = 0;
        for (uint32_t i = 0; i < MESSAGE_MUTATIONS; i++) {
            struct random_numbers random = {i};
            bool taken;
            size_t size =
                mutate(&random, source.bytes, source.size, (uint8_t *)mutated, 2 * source.size);
            const char *broken = try_message(mutated, size, command, &taken);
            broken_count += broken != NULL;
            taken_count += taken;
            stability_measure(run, broken_count, "%s, mutation %u: %s", name, i,
                              broken ? broken : "good");
        }
        check_fraction(run, name, taken_count, MESSAGE_MUTATIONS);
        free(source.bytes);
    }
    free(command);
    free(mutated);
}

// Numbers of a method besides its parameters, as PROTOCOL.md lists them.
static const struct number_field {
    const char *method, *field, *others; // fields that are required, too
    double min, max;
    bool whole;
} number_fields[] = {
    {"pick", "x", "\"y\":0", 0, 4096, false},
    {"pick", "y", "\"x\":0", 0, 2160, false},
    {"frame.ack", "frame_id", NULL, 0, PROTOCOL_MAX_SAFE_INTEGER, true},
    {"camera.set", "revision", NULL, 0, PROTOCOL_MAX_SAFE_INTEGER, true},
    {"light.remove", "id", NULL, 0, UINT32_MAX - 1.0, true},
    {"light.remove", "edit_id", "\"id\":0", 0, PROTOCOL_MAX_SAFE_INTEGER, true},
    {"texture.get", "image", NULL, 0, UINT32_MAX - 1.0, true},
    {"session.hello", "protocol", NULL, PROTOCOL_VERSION, PROTOCOL_VERSION, true},
    {"session.hello", "resume_epoch", NULL, 0, PROTOCOL_MAX_SAFE_INTEGER, true},
    {"session.hello", "resume_revision", NULL, 0, PROTOCOL_MAX_SAFE_INTEGER, true},
    {"accuracy.start", "noise", NULL, 0.0005, 0.1, false},
};

struct extremes {
    struct stability_run *run;
    struct command *command;
    uint32_t broken;
};

// `good` says whether the message must be accepted.
static void expect(struct extremes *extremes, const char *text, bool good)
{
    bool taken;
    const char *broken = try_message(text, strlen(text), extremes->command, &taken);
    if (!broken && taken != good)
        broken = good ? "was refused" : "was taken";
    extremes->broken += broken != NULL;
    stability_measure(extremes->run, extremes->broken, "%.100s: %s", text,
                      broken ? broken : "good");
}

// Numbers that JSON cannot express, texts that are no number, and numbers far beyond a range, just
// beyond it and at its ends. `format` is a printf format for the number's text.
static void try_numbers(struct extremes *extremes, const char *format, double min, double max,
                        bool whole, bool zero_is_good)
{
    static const char *const never[] = {"NaN",    "-NaN",  "Infinity", "-Infinity", "1e999",
                                        "-1e999", "null",  "\"1\"",    "[]",        "{}",
                                        "true",   "1e308", "-1e308",   "1e38",      "-1e38"};
    char text[512], number[40];
    for (size_t i = 0; i < sizeof(never) / sizeof(never[0]); i++) {
        snprintf(text, sizeof(text), format, never[i]);
        expect(extremes, text, false);
    }
    const struct {
        double number;
        bool good;
    } ends[] = {
        {min, zero_is_good || min != 0.0},
        {max, zero_is_good || max != 0.0},
        {whole ? min - 1.0 : nextafter(min, -INFINITY), false},
        {whole ? max + 1.0 : nextafter(max, INFINITY), false},
        {min + 0.5, !whole && min + 0.5 <= max},
    };
    for (size_t i = 0; i < sizeof(ends) / sizeof(ends[0]); i++) {
        snprintf(number, sizeof(number), "%.17g", ends[i].number);
        snprintf(text, sizeof(text), format, number);
        expect(extremes, text, ends[i].good);
    }
}

// A message that sets one parameter, with %s for one number of it.
static void write_format(const struct parameter *parameter, uint32_t component, char out[400])
{
    static const char *const openings[GROUP_COUNT] = {
        [GROUP_LIGHT] = "\"light.update\",\"params\":{\"id\":0,\"set\":{",
        [GROUP_MATERIAL] = "\"material.update\",\"params\":{\"id\":0,\"set\":{",
        [GROUP_NODE] = "\"node.update\",\"params\":{\"id\":0,\"set\":{",
        [GROUP_ENVIRONMENT] = "\"environment.update\",\"params\":{\"set\":{",
        [GROUP_SETTINGS] = "\"settings.update\",\"params\":{\"set\":{",
        [GROUP_ANIMATION] = "\"animation.set\",\"params\":{\"id\":0,\"set\":{",
        [GROUP_VIEW] = "\"view.configure\",\"params\":{",
        [GROUP_CAMERA] = "\"camera.set\",\"params\":{",
    };
    bool flat = parameter->group == GROUP_VIEW || parameter->group == GROUP_CAMERA;
    uint32_t count = parameter_component_count(parameter->type);
    int used = snprintf(out, 400, "{\"jsonrpc\":\"2.0\",\"id\":1,\"method\":%s\"%s\":%s",
                        openings[parameter->group], parameter->name, count > 1 ? "[" : "");
    for (uint32_t i = 0; i < count; i++)
        used += snprintf(out + used, 400 - (size_t)used, "%s%s", i ? "," : "",
                         i == component ? "%s" : "0.5");
    snprintf(out + used, 400 - (size_t)used, "%s%s}}", count > 1 ? "]" : "", flat ? "" : "}");
}

static void try_parameter(struct extremes *extremes, const struct parameter *parameter)
{
    uint32_t count = parameter_component_count(parameter->type);
    bool is_number = parameter->type != PARAMETER_BOOL && parameter->type != PARAMETER_ENUM;
    char format[400], text[512];
    for (uint32_t i = 0; i < count && is_number; i++) {
        write_format(parameter, i, format);
        try_numbers(extremes, format, parameter->min, parameter->max,
                    parameter->type == PARAMETER_INT, true);
    }
    static const char *const wrong[] = {"NaN", "1e999", "null", "-1", "2", "[true]", "{}", "\"?\""};
    write_format(parameter, 0, format);
    for (size_t i = 0; !is_number && i < sizeof(wrong) / sizeof(wrong[0]); i++) {
        snprintf(text, sizeof(text), format, wrong[i]);
        expect(extremes, text, false);
    }
}

static void run_extremes(struct stability_run *run)
{
    struct extremes extremes = {.run = run, .command = malloc(sizeof(*extremes.command))};
    for (size_t i = 0; extremes.command && i < parameter_count(); i++)
        if (parameter_at(i)->type != PARAMETER_STRING)
            try_parameter(&extremes, parameter_at(i));
    for (size_t i = 0; i < sizeof(number_fields) / sizeof(number_fields[0]); i++) {
        const struct number_field *field = &number_fields[i];
        char format[400];
        snprintf(format, sizeof(format),
                 "{\"jsonrpc\":\"2.0\",\"id\":1,\"method\":\"%s\",\"params\":{%s%s\"%s\":%%s}}",
                 field->method, field->others ? field->others : "", field->others ? "," : "",
                 field->field);
        try_numbers(&extremes, format, field->min, field->max, field->whole, true);
    }
    free(extremes.command);
}

static const struct stability_case cases[] = {
    {.name = "mutated-files",
     .invariant = "10,000 mutations of each good file, of every kind that scenes are read from, "
                  "are refused with a reason or give a valid scene",
     .methods = STABILITY_NONE,
     .unit = "broken files",
     .run = run_files},
    {.name = "mutated-environments",
     .invariant =
         "90,000 mutations of good OpenEXR and Radiance files are refused with a reason or "
         "give an image of finite radiance",
     .methods = STABILITY_NONE,
     .unit = "broken files",
     .run = run_environments},
    {.name = "mutated-messages",
     .invariant = "200,000 mutations of good messages are refused with a reason or hold values "
                  "within their ranges",
     .methods = STABILITY_NONE,
     .unit = "broken messages",
     .run = run_messages},
    {.name = "extreme-parameters",
     .invariant = "every number of every method is taken at the ends of its range, and refused "
                  "just beyond, at 1e38 and where it is none",
     .methods = STABILITY_NONE,
     .unit = "wrong answers",
     .run = run_extremes},
    {.name = "edit-sequences",
     .invariant = "100,000 random sequences of valid edits by two people leave a valid document, "
                  "and are the same when taken back and made again",
     .methods = STABILITY_NONE,
     .unit = "broken sequences",
     .run = hostile_run_edits},
    {.name = "extremes-drawn",
     .invariant = "each parameter of lights, materials, nodes, environment, settings and camera "
                  "draws finite images at both ends of its range",
     .methods = STABILITY_DRAWN,
     .unit = "values",
     .run = hostile_run_drawn},
};

const struct stability_table stability_hostile = {
    .name = "hostile",
    .title = "Hostile files, messages and edits",
    .cases = cases,
    .count = sizeof(cases) / sizeof(cases[0]),
};
