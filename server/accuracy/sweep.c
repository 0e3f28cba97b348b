// Sweeps of settings: the named ones, and those in files.
#include <cjson/cJSON.h>
#include <ctype.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "protocol/parameters.h"
#include "server/accuracy/accuracy.h"
#include "server/document/document_text.h"

#define MAX_SWEEP_BYTES (1u << 20)

static struct configuration *add_configuration(struct sweep *sweep, const char *name,
                                               enum quality quality)
{
    if (sweep->configuration_count == SWEEP_MAX_CONFIGURATIONS)
        return NULL;
    struct configuration *configuration = &sweep->configurations[sweep->configuration_count++];
    *configuration = (struct configuration){.quality = quality, .scale = 1.0};
    snprintf(configuration->name, sizeof(configuration->name), "%s", name);
    return configuration;
}

static bool add_set(struct configuration *configuration, const char *key, const char *value)
{
    if (configuration->set_count == CONFIGURATION_MAX_SETS ||
        strlen(key) >= CONFIGURATION_TEXT_SIZE || strlen(value) >= CONFIGURATION_TEXT_SIZE)
        return false;
    snprintf(configuration->sets[configuration->set_count].key, CONFIGURATION_TEXT_SIZE, "%s", key);
    snprintf(configuration->sets[configuration->set_count++].value, CONFIGURATION_TEXT_SIZE, "%s",
             value);
    return true;
}

static void add_presets(struct sweep *sweep)
{
    struct configuration *none = add_configuration(sweep, "none", QUALITY_INTERACTIVE);
    add_set(none, "gi_method", "none");
    for (int i = 0; i < QUALITY_COUNT; i++)
        add_configuration(sweep, quality_names[i], (enum quality)i);
}

// Variations of single settings start from this: rays would hide the effect of cones and voxels.
static struct configuration *add_base(struct sweep *sweep, const char *name, const char *method)
{
    struct configuration *configuration = add_configuration(sweep, name, QUALITY_HIGH);
    if (configuration) {
        add_set(configuration, "gi_method", method);
        add_set(configuration, "gather_mode", gather_mode_names[GATHER_CACHE]);
    }
    return configuration;
}

static void add_variation(struct sweep *sweep, const char *method, const char *key,
                          const char *value)
{
    char name[CONFIGURATION_NAME_SIZE];
    snprintf(name, sizeof(name), "%s-%s-%s", method, key, value);
    struct configuration *configuration = add_base(sweep, name, method);
    if (configuration)
        add_set(configuration, key, value);
}

// Voxels and the start of cones determine time and error most, so all combinations are measured.
static void add_crossed(struct sweep *sweep, enum gi_method method)
{
    static const enum gather_mode final_gather_modes[] = {GATHER_CACHE, GATHER_HALF, GATHER_PIXEL};
    for (int voxels = VOXEL_RESOLUTION_64; voxels < VOXEL_RESOLUTION_COUNT; voxels++)
        for (int i = 0; i < 3; i++) {
            char name[CONFIGURATION_NAME_SIZE];
            if (method == GI_METHOD_CLIPMAP && voxels == VOXEL_RESOLUTION_256)
                continue;
            snprintf(name, sizeof(name), "%s-%s-%s", gi_method_names[method],
                     voxel_resolution_names[voxels], gather_mode_names[final_gather_modes[i]]);
            struct configuration *configuration = add_configuration(sweep, name, QUALITY_HIGH);
            if (!configuration)
                return;
            add_set(configuration, "gi_method", gi_method_names[method]);
            add_set(configuration, "voxel_resolution", voxel_resolution_names[voxels]);
            add_set(configuration, "gather_mode", gather_mode_names[final_gather_modes[i]]);
        }
}

static void add_varied(struct sweep *sweep, enum gi_method method)
{
    static const char *const variations[][2] = {{"cone_set", "5"},
                                                {"cone_set", "6"},
                                                {"cone_set", "16"},
                                                {"cone_set", "32"},
                                                {"cone_step", "0.25"},
                                                {"cone_step", "0.5"},
                                                {"cone_step", "2"},
                                                {"bounces", "1"},
                                                {"bounces", "2"},
                                                {"bounces", "4"},
                                                {"voxel_directions", "isotropic"},
                                                {"gather_mode", "rays"}};
    static const char *const levels[] = {"1", "2", "4", "6"};
    static const double scales[] = {0.5, 2.0};
    const char *name = gi_method_names[method];
    for (size_t i = 0; i < sizeof(variations) / sizeof(variations[0]); i++)
        add_variation(sweep, name, variations[i][0], variations[i][1]);
    for (size_t i = 0; i < 4 && method == GI_METHOD_CLIPMAP; i++)
        add_variation(sweep, name, "clip_levels", levels[i]);
    for (size_t i = 0; i < 2; i++) {
        char configuration_name[CONFIGURATION_NAME_SIZE];
        snprintf(configuration_name, sizeof(configuration_name), "%s-scale-%g", name, scales[i]);
        struct configuration *configuration = add_base(sweep, configuration_name, name);
        if (configuration)
            configuration->scale = scales[i];
    }
}

static bool read_name(const cJSON *item, struct configuration *configuration,
                      struct error *out_error)
{
    const char *name = cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(item, "name"));
    size_t length = name ? strlen(name) : 0;
    bool fine = length > 0 && length < CONFIGURATION_NAME_SIZE && name[0] != '.';
    for (size_t i = 0; i < length && fine; i++)
        fine = isalnum((unsigned char)name[i]) || strchr("-_.", name[i]);
    if (!fine)
        return error_set(out_error,
                         "a configuration's name is \"%.80s\"; 1 to %u letters, digits, '-', "
                         "'_' and '.' are needed",
                         name ? name : "", CONFIGURATION_NAME_SIZE - 1);
    snprintf(configuration->name, sizeof(configuration->name), "%s", name);
    return true;
}

static bool read_preset(const cJSON *item, struct configuration *configuration,
                        struct error *out_error)
{
    const cJSON *preset = cJSON_GetObjectItemCaseSensitive(item, "preset");
    configuration->quality = QUALITY_HIGH;
    if (!preset)
        return true;
    for (int i = 0; i < QUALITY_COUNT; i++)
        if (cJSON_IsString(preset) && strcmp(preset->valuestring, quality_names[i]) == 0) {
            configuration->quality = (enum quality)i;
            return true;
        }
    return error_set(out_error, "configuration %s: preset allows draft, interactive, high, final",
                     configuration->name);
}

static bool read_scale(const cJSON *item, struct configuration *configuration,
                       struct error *out_error)
{
    const cJSON *scale = cJSON_GetObjectItemCaseSensitive(item, "scale");
    configuration->scale = scale ? cJSON_GetNumberValue(scale) : 1.0;
    return (configuration->scale >= 0.25 && configuration->scale <= 1.0) ||
           configuration->scale == 2.0 ||
           error_set(out_error, "configuration %s: scale allows 0.25 to 1, and 2",
                     configuration->name);
}

static bool read_sets(const cJSON *item, struct configuration *configuration,
                      struct error *out_error)
{
    const cJSON *sets = cJSON_GetObjectItemCaseSensitive(item, "set"), *set;
    if (sets && !cJSON_IsObject(sets))
        return error_set(out_error, "configuration %s: set is {\"KEY\": VALUE, ...}",
                         configuration->name);
    cJSON_ArrayForEach(set, sets)
    {
        char *text = cJSON_IsString(set) ? strdup(set->valuestring) : cJSON_PrintUnformatted(set);
        bool done = text && add_set(configuration, set->string, text);
        free(text);
        if (!done)
            return error_set(
                out_error,
                "configuration %s: \"%.80s\" is too long, or there are more than %u settings",
                configuration->name, set->string, CONFIGURATION_MAX_SETS);
    }
    return true;
}

static bool read_configurations(const cJSON *array, struct sweep *sweep, struct error *out_error)
{
    const cJSON *item;
    if (!cJSON_IsArray(array) || cJSON_GetArraySize(array) == 0)
        return error_set(out_error, "an array of configurations is needed");
    cJSON_ArrayForEach(item, array)
    {
        struct configuration *configuration = add_configuration(sweep, "", QUALITY_HIGH);
        if (!configuration)
            return error_set(out_error, "more than %u configurations", SWEEP_MAX_CONFIGURATIONS);
        if (!read_name(item, configuration, out_error) ||
            !read_preset(item, configuration, out_error) ||
            !read_scale(item, configuration, out_error) ||
            !read_sets(item, configuration, out_error))
            return false;
        for (uint32_t i = 0; i + 1 < sweep->configuration_count; i++)
            if (strcmp(sweep->configurations[i].name, configuration->name) == 0)
                return error_set(out_error, "two configurations have the name %s",
                                 configuration->name);
    }
    return true;
}

static bool load_file(const char *path, struct sweep *sweep, struct error *out_error)
{
    FILE *file = fopen(path, "rb");
    if (!file)
        return error_set(out_error,
                         "--ladder is \"%.200s\"; quick, full or a file is needed, and this file "
                         "cannot be read: %s",
                         path, strerror(errno));
    char *text = calloc(1, MAX_SWEEP_BYTES + 1);
    size_t length = text ? fread(text, 1, MAX_SWEEP_BYTES + 1, file) : 0;
    fclose(file);
    cJSON *array = length > 0 && length <= MAX_SWEEP_BYTES ? cJSON_Parse(text) : NULL;
    struct error error = {""};
    bool done = array ? read_configurations(array, sweep, &error)
                      : error_set(&error, "no JSON of up to %u bytes", MAX_SWEEP_BYTES);
    cJSON_Delete(array);
    free(text);
    return done || error_set(out_error, "sweep \"%.200s\": %.280s", path, error.message);
}

bool sweep_load(const char *name, struct sweep *out_sweep, struct error *out_error)
{
    struct frame_params params = {0};
    out_sweep->configuration_count = 0;
    if (strcmp(name, "quick") == 0) {
        add_presets(out_sweep);
    } else if (strcmp(name, "full") == 0) {
        add_presets(out_sweep);
        add_crossed(out_sweep, GI_METHOD_CLIPMAP);
        add_crossed(out_sweep, GI_METHOD_GRID);
        add_varied(out_sweep, GI_METHOD_CLIPMAP);
        add_varied(out_sweep, GI_METHOD_GRID);
    } else if (!load_file(name, out_sweep, out_error)) {
        return false;
    }
    for (uint32_t i = 0; i < out_sweep->configuration_count; i++) {
        render_settings_init(&params.settings);
        if (!configuration_apply(&out_sweep->configurations[i], &params, out_error))
            return false;
    }
    return true;
}

bool configuration_apply(const struct configuration *configuration, struct frame_params *params,
                         struct error *out_error)
{
    params->quality = configuration->quality;
    for (uint32_t i = 0; i < configuration->set_count; i++) {
        const char *key = configuration->sets[i].key;
        struct error error = {""};
        if (strncmp(key, "settings.", 9) == 0)
            key += 9;
        if (!parameter_find(GROUP_SETTINGS, key))
            return error_set(out_error, "configuration %s: \"%s\" is no field of settings",
                             configuration->name, key);
        if (!document_set_text(NULL, &params->settings, NULL, key, configuration->sets[i].value,
                               &error))
            return error_set(out_error, "configuration %s: %.400s", configuration->name,
                             error.message);
    }
    return params->settings.gi_method != GI_METHOD_REFERENCE ||
           error_set(out_error, "configuration %s: the reference is no configuration to measure",
                     configuration->name);
}

cJSON *configuration_json(const struct configuration *configuration)
{
    cJSON *json = cJSON_CreateObject();
    cJSON_AddStringToObject(json, "preset", quality_names[configuration->quality]);
    cJSON_AddNumberToObject(json, "scale", configuration->scale);
    cJSON *sets = cJSON_AddObjectToObject(json, "set");
    for (uint32_t i = 0; i < configuration->set_count; i++)
        cJSON_AddStringToObject(sets, configuration->sets[i].key, configuration->sets[i].value);
    return json;
}
