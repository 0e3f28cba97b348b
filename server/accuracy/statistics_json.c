#include "server/accuracy/statistics_json.h"

#include <cjson/cJSON.h>

static cJSON *add_named(cJSON *list, const char *name)
{
    cJSON *item = cJSON_CreateObject();
    cJSON_AddStringToObject(item, "name", name);
    cJSON_AddItemToArray(list, item);
    return item;
}

static void add_passes(cJSON *object, const struct frame_statistics *statistics,
                       const struct statistics_format *format)
{
    cJSON *passes = cJSON_AddArrayToObject(object, "passes");
    for (uint32_t i = 0; i < statistics->pass_count; i++) {
        const struct pass_statistics *pass = &statistics->passes[i];
        cJSON *item = add_named(passes, pass->name);
        format->add_times(item, statistics, i, format->user);
        cJSON_AddStringToObject(item, "reason", pass->reason ? pass->reason : "");
    }
}

static void add_effects(cJSON *object, const struct frame_statistics *statistics)
{
    cJSON *effects = cJSON_AddArrayToObject(object, "effects");
    for (uint32_t i = 0; i < statistics->effect_count; i++) {
        cJSON *item = add_named(effects, statistics->effects[i].name);
        cJSON_AddBoolToObject(item, "on", statistics->effects[i].on);
        cJSON_AddStringToObject(item, "reason", statistics->effects[i].reason);
    }
}

static void add_amount(cJSON *amounts, const char *name, const char *key, double amount)
{
    if (cJSON_IsArray(amounts))
        cJSON_AddNumberToObject(add_named(amounts, name), key, amount);
    else
        cJSON_AddNumberToObject(amounts, name, amount);
}

void statistics_add_json(cJSON *object, const struct frame_statistics *statistics,
                         const struct statistics_format *format)
{
    cJSON *(*add_amounts)(cJSON *, const char *) =
        format->lists ? cJSON_AddArrayToObject : cJSON_AddObjectToObject;
    add_passes(object, statistics, format);
    add_effects(object, statistics);
    cJSON *memory = add_amounts(object, format->memory_key);
    for (uint32_t i = 0; i < statistics->memory_count; i++)
        add_amount(memory, statistics->memory[i].name, "bytes",
                   (double)statistics->memory[i].bytes);
    cJSON *rejects = add_amounts(object, "rejects");
    for (uint32_t i = 0; i < statistics->reject_count; i++)
        add_amount(rejects, statistics->rejects[i].name, "count",
                   (double)statistics->rejects[i].count);
}
