#include "server/accuracy/measurement.h"

#include <cjson/cJSON.h>
#include <math.h>
#include <stdio.h>

#include "server/accuracy/statistics_json.h"

bool measurement_add(struct measurement *measurement, const struct frame_statistics *statistics)
{
    bool done = samples_add(&measurement->frame_ms, statistics->frame_time_ms);
    for (uint32_t i = 0; i < statistics->pass_count; i++)
        if (statistics->passes[i].ran)
            done = done && samples_add(&measurement->pass_ms[i], statistics->passes[i].time_ms);
    return done;
}

void measurement_finish(struct measurement *measurement)
{
    samples_finish(&measurement->frame_ms);
    for (uint32_t i = 0; i < RENDERER_MAX_PASSES; i++)
        samples_finish(&measurement->pass_ms[i]);
}

static double round_to(double value, double step)
{
    return round(value / step) * step;
}

static void add_quantiles(cJSON *object, const char *name, const struct samples *samples)
{
    cJSON *quantiles = cJSON_AddObjectToObject(object, name);
    cJSON_AddNumberToObject(quantiles, "median", round_to(samples_quantile(samples, 0.5), 1e-3));
    cJSON_AddNumberToObject(quantiles, "p95", round_to(samples_quantile(samples, 0.95), 1e-3));
}

static void add_pass_quantiles(cJSON *pass, const struct frame_statistics *statistics,
                               uint32_t index, const void *user)
{
    const struct measurement *measurement = user;
    const struct samples *pass_ms = &measurement->pass_ms[index];
    cJSON_AddBoolToObject(pass, "ran", pass_ms->count > 0);
    cJSON_AddNumberToObject(pass, "frames", pass_ms->count);
    add_quantiles(pass, "ms", pass_ms);
    cJSON_AddNumberToObject(pass, "view_bytes", (double)statistics->passes[index].view_bytes);
}

cJSON *measurement_json(const struct measurement *measurement,
                        const struct frame_statistics *statistics, const struct renderer_info *info,
                        const struct scene *scene, uint32_t width, uint32_t height)
{
    cJSON *root = cJSON_CreateObject();
    cJSON_AddStringToObject(root, "gl_renderer", info->gl_renderer);
    char size[32];
    snprintf(size, sizeof(size), "%ux%u", width, height);
    cJSON_AddStringToObject(root, "size", size);
    cJSON_AddNumberToObject(root, "frames", measurement->frame_ms.count);
    add_quantiles(root, "frame_ms", &measurement->frame_ms);
    statistics_add_json(root, statistics,
                        &(struct statistics_format){.add_times = add_pass_quantiles,
                                                    .user = measurement,
                                                    .memory_key = "memory_bytes"});
    cJSON *contents = cJSON_AddObjectToObject(root, "scene");
    uint32_t lights = 0;
    for (uint32_t i = 0; i < scene->light_count; i++)
        lights += !scene->lights[i].removed;
    cJSON_AddNumberToObject(contents, "triangles", (double)scene_triangle_count(scene));
    cJSON_AddNumberToObject(contents, "materials", scene->material_count);
    cJSON_AddNumberToObject(contents, "lights", lights);
    return root;
}
