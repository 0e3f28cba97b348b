// Ladders of settings: those with a name, and those in files.
#include <cjson/cJSON.h>
#include <ctype.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/accuracy.h"

#define MAX_LADDER_BYTES (1u << 20)

static struct rung *add_rung(struct ladder *ladder, const char *name, enum quality quality)
{
    if (ladder->rung_count == LADDER_MAX_RUNGS)
        return NULL;
    struct rung *rung = &ladder->rungs[ladder->rung_count++];
    *rung = (struct rung){.quality = quality, .scale = 1.0};
    snprintf(rung->name, sizeof(rung->name), "%s", name);
    return rung;
}

static bool add_set(struct rung *rung, const char *key, const char *value)
{
    if (rung->set_count == RUNG_MAX_SETS || strlen(key) >= RUNG_TEXT_SIZE ||
        strlen(value) >= RUNG_TEXT_SIZE)
        return false;
    snprintf(rung->sets[rung->set_count].key, RUNG_TEXT_SIZE, "%s", key);
    snprintf(rung->sets[rung->set_count++].value, RUNG_TEXT_SIZE, "%s", value);
    return true;
}

static void add_presets(struct ladder *ladder)
{
    struct rung *none = add_rung(ladder, "none", QUALITY_INTERACTIVE);
    add_set(none, "gi_method", "none");
    for (int i = 0; i < QUALITY_COUNT; i++)
        add_rung(ladder, quality_names[i], (enum quality)i);
}

// What variations of one setting start from: rays would hide what cones and voxels do.
static struct rung *add_base(struct ladder *ladder, const char *name, const char *method)
{
    struct rung *rung = add_rung(ladder, name, QUALITY_HIGH);
    if (rung) {
        add_set(rung, "gi_method", method);
        add_set(rung, "gather_mode", gather_mode_names[GATHER_CACHE]);
    }
    return rung;
}

static void add_variation(struct ladder *ladder, const char *method, const char *key,
                          const char *value)
{
    char name[RUNG_NAME_SIZE];
    snprintf(name, sizeof(name), "%s-%s-%s", method, key, value);
    struct rung *rung = add_base(ladder, name, method);
    if (rung)
        add_set(rung, key, value);
}

// Voxels and where cones start decide time and error most, so they are crossed.
static void add_crossed(struct ladder *ladder, enum gi_method method)
{
    static const enum gather_mode gathers[] = {GATHER_CACHE, GATHER_HALF, GATHER_PIXEL};
    for (int voxels = VOXEL_RESOLUTION_64; voxels < VOXEL_RESOLUTION_COUNT; voxels++)
        for (int i = 0; i < 3; i++) {
            char name[RUNG_NAME_SIZE];
            if (method == GI_METHOD_CLIPMAP && voxels == VOXEL_RESOLUTION_256)
                continue;
            snprintf(name, sizeof(name), "%s-%s-%s", gi_method_names[method],
                     voxel_resolution_names[voxels], gather_mode_names[gathers[i]]);
            struct rung *rung = add_rung(ladder, name, QUALITY_HIGH);
            if (!rung)
                return;
            add_set(rung, "gi_method", gi_method_names[method]);
            add_set(rung, "voxel_resolution", voxel_resolution_names[voxels]);
            add_set(rung, "gather_mode", gather_mode_names[gathers[i]]);
        }
}

static void add_varied(struct ladder *ladder, enum gi_method method)
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
        add_variation(ladder, name, variations[i][0], variations[i][1]);
    for (size_t i = 0; i < 4 && method == GI_METHOD_CLIPMAP; i++)
        add_variation(ladder, name, "clip_levels", levels[i]);
    for (size_t i = 0; i < 2; i++) {
        char rung_name[RUNG_NAME_SIZE];
        snprintf(rung_name, sizeof(rung_name), "%s-scale-%g", name, scales[i]);
        struct rung *rung = add_base(ladder, rung_name, name);
        if (rung)
            rung->scale = scales[i];
    }
}

static bool read_name(const cJSON *item, struct rung *rung, struct error *out_error)
{
    const char *name = cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(item, "name"));
    size_t length = name ? strlen(name) : 0;
    bool fine = length > 0 && length < RUNG_NAME_SIZE && name[0] != '.';
    for (size_t i = 0; i < length && fine; i++)
        fine = isalnum((unsigned char)name[i]) || strchr("-_.", name[i]);
    if (!fine)
        return error_set(out_error,
                         "a rung's name is \"%.80s\"; 1 to %u letters, digits, '-', "
                         "'_' and '.' are needed",
                         name ? name : "", RUNG_NAME_SIZE - 1);
    snprintf(rung->name, sizeof(rung->name), "%s", name);
    return true;
}

static bool read_preset(const cJSON *item, struct rung *rung, struct error *out_error)
{
    const cJSON *preset = cJSON_GetObjectItemCaseSensitive(item, "preset");
    rung->quality = QUALITY_HIGH;
    if (!preset)
        return true;
    for (int i = 0; i < QUALITY_COUNT; i++)
        if (cJSON_IsString(preset) && strcmp(preset->valuestring, quality_names[i]) == 0) {
            rung->quality = (enum quality)i;
            return true;
        }
    return error_set(out_error, "rung %s: preset allows draft, interactive, high, final",
                     rung->name);
}

static bool read_scale(const cJSON *item, struct rung *rung, struct error *out_error)
{
    const cJSON *scale = cJSON_GetObjectItemCaseSensitive(item, "scale");
    rung->scale = scale ? cJSON_GetNumberValue(scale) : 1.0;
    return (rung->scale >= 0.25 && rung->scale <= 1.0) || rung->scale == 2.0 ||
           error_set(out_error, "rung %s: scale allows 0.25 to 1, and 2", rung->name);
}

static bool read_sets(const cJSON *item, struct rung *rung, struct error *out_error)
{
    const cJSON *sets = cJSON_GetObjectItemCaseSensitive(item, "set"), *set;
    if (sets && !cJSON_IsObject(sets))
        return error_set(out_error, "rung %s: set is {\"KEY\": VALUE, ...}", rung->name);
    cJSON_ArrayForEach(set, sets)
    {
        char *text = cJSON_IsString(set) ? strdup(set->valuestring) : cJSON_PrintUnformatted(set);
        bool done = text && add_set(rung, set->string, text);
        free(text);
        if (!done)
            return error_set(out_error,
                             "rung %s: \"%.80s\" is too long, or there are more than %u settings",
                             rung->name, set->string, RUNG_MAX_SETS);
    }
    return true;
}

static bool read_rungs(const cJSON *array, struct ladder *ladder, struct error *out_error)
{
    const cJSON *item;
    if (!cJSON_IsArray(array) || cJSON_GetArraySize(array) == 0)
        return error_set(out_error, "an array of rungs is needed");
    cJSON_ArrayForEach(item, array)
    {
        struct rung *rung = add_rung(ladder, "", QUALITY_HIGH);
        if (!rung)
            return error_set(out_error, "more than %u rungs", LADDER_MAX_RUNGS);
        if (!read_name(item, rung, out_error) || !read_preset(item, rung, out_error) ||
            !read_scale(item, rung, out_error) || !read_sets(item, rung, out_error))
            return false;
        for (uint32_t i = 0; i + 1 < ladder->rung_count; i++)
            if (strcmp(ladder->rungs[i].name, rung->name) == 0)
                return error_set(out_error, "two rungs have the name %s", rung->name);
    }
    return true;
}

static bool load_file(const char *path, struct ladder *ladder, struct error *out_error)
{
    FILE *file = fopen(path, "rb");
    if (!file)
        return error_set(out_error,
                         "--ladder is \"%.200s\"; quick, full or a file is needed, and this file "
                         "cannot be read: %s",
                         path, strerror(errno));
    char *text = calloc(1, MAX_LADDER_BYTES + 1);
    size_t length = text ? fread(text, 1, MAX_LADDER_BYTES + 1, file) : 0;
    fclose(file);
    cJSON *array = length > 0 && length <= MAX_LADDER_BYTES ? cJSON_Parse(text) : NULL;
    struct error error = {""};
    bool done = array ? read_rungs(array, ladder, &error)
                      : error_set(&error, "no JSON of up to %u bytes", MAX_LADDER_BYTES);
    cJSON_Delete(array);
    free(text);
    return done || error_set(out_error, "ladder \"%.200s\": %.280s", path, error.message);
}

bool ladder_load(const char *name, struct ladder *out_ladder, struct error *out_error)
{
    struct frame_params params = {0};
    out_ladder->rung_count = 0;
    if (strcmp(name, "quick") == 0) {
        add_presets(out_ladder);
    } else if (strcmp(name, "full") == 0) {
        add_presets(out_ladder);
        add_crossed(out_ladder, GI_METHOD_CLIPMAP);
        add_crossed(out_ladder, GI_METHOD_GRID);
        add_varied(out_ladder, GI_METHOD_CLIPMAP);
        add_varied(out_ladder, GI_METHOD_GRID);
    } else if (!load_file(name, out_ladder, out_error)) {
        return false;
    }
    for (uint32_t i = 0; i < out_ladder->rung_count; i++) {
        render_settings_init(&params.settings);
        if (!rung_apply(&out_ladder->rungs[i], &params, out_error))
            return false;
    }
    return true;
}

bool rung_apply(const struct rung *rung, struct frame_params *params, struct error *out_error)
{
    params->quality = rung->quality;
    for (uint32_t i = 0; i < rung->set_count; i++) {
        const char *key = rung->sets[i].key;
        struct error error = {""};
        if (strncmp(key, "settings.", 9) == 0)
            key += 9;
        if (!parameter_find(GROUP_SETTINGS, key))
            return error_set(out_error, "rung %s: \"%s\" is no field of settings", rung->name, key);
        if (!document_set_text(NULL, &params->settings, NULL, key, rung->sets[i].value, &error))
            return error_set(out_error, "rung %s: %.400s", rung->name, error.message);
    }
    return params->settings.gi_method != GI_METHOD_REFERENCE ||
           error_set(out_error, "rung %s: the reference is the truth, and no rung", rung->name);
}

cJSON *rung_json(const struct rung *rung)
{
    cJSON *json = cJSON_CreateObject();
    cJSON_AddStringToObject(json, "preset", quality_names[rung->quality]);
    cJSON_AddNumberToObject(json, "scale", rung->scale);
    cJSON *sets = cJSON_AddObjectToObject(json, "set");
    for (uint32_t i = 0; i < rung->set_count; i++)
        cJSON_AddStringToObject(sets, rung->sets[i].key, rung->sets[i].value);
    return json;
}
