// Statistics of frames: quantiles and their JSON.
#include <cjson/cJSON.h>
#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/cli.h"

int cli_fail(int status, const char *format, ...)
{
    char message[ERROR_MESSAGE_SIZE + 64];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message, sizeof(message), format, arguments);
    va_end(arguments);
    for (char *at = message; *at; at++) // one line, whatever a driver's log held
        if (*at == '\n')
            *at = ' ';
    fprintf(stderr, "%s: %s\n", program_invocation_short_name, message);
    return status;
}

bool cli_samples_add(struct cli_samples *samples, double value)
{
    if (samples->count == samples->capacity) {
        uint32_t capacity = samples->capacity ? 2 * samples->capacity : 64;
        double *grown = realloc(samples->values, capacity * sizeof(*grown));
        if (!grown)
            return false;
        samples->values = grown;
        samples->capacity = capacity;
    }
    samples->values[samples->count++] = value;
    return true;
}

void cli_samples_finish(struct cli_samples *samples)
{
    free(samples->values);
    *samples = (struct cli_samples){0};
}

static int compare_doubles(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

double cli_samples_quantile(const struct cli_samples *samples, double quantile)
{
    if (samples->count == 0)
        return 0.0;
    double *sorted = malloc(samples->count * sizeof(*sorted));
    if (!sorted)
        return 0.0;
    memcpy(sorted, samples->values, samples->count * sizeof(*sorted));
    qsort(sorted, samples->count, sizeof(*sorted), compare_doubles);
    double rank = ceil(quantile * samples->count);
    double value = sorted[rank < 1.0 ? 0 : (uint32_t)rank - 1];
    free(sorted);
    return value;
}

bool cli_measurement_add(struct cli_measurement *measurement,
                         const struct frame_statistics *statistics)
{
    bool done = cli_samples_add(&measurement->frame_ms, statistics->frame_time_ms);
    for (uint32_t i = 0; i < statistics->pass_count; i++)
        if (statistics->passes[i].ran)
            done = done && cli_samples_add(&measurement->pass_ms[i], statistics->passes[i].time_ms);
    return done;
}

void cli_measurement_finish(struct cli_measurement *measurement)
{
    cli_samples_finish(&measurement->frame_ms);
    for (uint32_t i = 0; i < RENDERER_MAX_PASSES; i++)
        cli_samples_finish(&measurement->pass_ms[i]);
}

static double round_to(double value, double step)
{
    return round(value / step) * step;
}

static void add_quantiles(cJSON *object, const char *name, const struct cli_samples *samples)
{
    cJSON *quantiles = cJSON_AddObjectToObject(object, name);
    cJSON_AddNumberToObject(quantiles, "median",
                            round_to(cli_samples_quantile(samples, 0.5), 1e-3));
    cJSON_AddNumberToObject(quantiles, "p95", round_to(cli_samples_quantile(samples, 0.95), 1e-3));
}

cJSON *cli_statistics_json(const struct cli_measurement *measurement,
                           const struct frame_statistics *statistics,
                           const struct renderer_info *info, const struct scene *scene,
                           uint32_t width, uint32_t height)
{
    cJSON *root = cJSON_CreateObject();
    cJSON_AddStringToObject(root, "gl_renderer", info->gl_renderer);
    char size[32];
    snprintf(size, sizeof(size), "%ux%u", width, height);
    cJSON_AddStringToObject(root, "size", size);
    cJSON_AddNumberToObject(root, "frames", measurement->frame_ms.count);
    add_quantiles(root, "frame_ms", &measurement->frame_ms);
    cJSON *passes = cJSON_AddArrayToObject(root, "passes");
    for (uint32_t i = 0; i < statistics->pass_count; i++) {
        const struct pass_statistics *pass = &statistics->passes[i];
        cJSON *entry = cJSON_CreateObject();
        cJSON_AddStringToObject(entry, "name", pass->name);
        cJSON_AddBoolToObject(entry, "ran", measurement->pass_ms[i].count > 0);
        cJSON_AddNumberToObject(entry, "frames", measurement->pass_ms[i].count);
        add_quantiles(entry, "ms", &measurement->pass_ms[i]);
        cJSON_AddStringToObject(entry, "reason", pass->reason);
        cJSON_AddItemToArray(passes, entry);
    }
    cJSON *effects = cJSON_AddArrayToObject(root, "effects");
    for (uint32_t i = 0; i < statistics->effect_count; i++) {
        cJSON *entry = cJSON_CreateObject();
        cJSON_AddStringToObject(entry, "name", statistics->effects[i].name);
        cJSON_AddBoolToObject(entry, "on", statistics->effects[i].on);
        cJSON_AddStringToObject(entry, "reason", statistics->effects[i].reason);
        cJSON_AddItemToArray(effects, entry);
    }
    cJSON *memory = cJSON_AddObjectToObject(root, "memory_bytes");
    for (uint32_t i = 0; i < statistics->memory_count; i++)
        cJSON_AddNumberToObject(memory, statistics->memory[i].name,
                                (double)statistics->memory[i].bytes);
    cJSON *rejects = cJSON_AddObjectToObject(root, "rejects");
    for (uint32_t i = 0; i < statistics->reject_count; i++)
        cJSON_AddNumberToObject(rejects, statistics->rejects[i].name,
                                (double)statistics->rejects[i].count);
    cJSON *contents = cJSON_AddObjectToObject(root, "scene");
    uint32_t lights = 0;
    for (uint32_t i = 0; i < scene->light_count; i++)
        lights += !scene->lights[i].removed;
    cJSON_AddNumberToObject(contents, "triangles", (double)scene_triangle_count(scene));
    cJSON_AddNumberToObject(contents, "materials", scene->material_count);
    cJSON_AddNumberToObject(contents, "lights", lights);
    return root;
}
