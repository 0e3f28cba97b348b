// document_set_text(): keys and values as a person types them.
#include "server/document/document_text.h"

#include <stdlib.h>
#include <string.h>

static const struct {
    const char *prefix;
    enum parameter_group group;
    bool list;
} prefixes[] = {
    {"lights.", GROUP_LIGHT, true},       {"materials.", GROUP_MATERIAL, true},
    {"nodes.", GROUP_NODE, true},         {"environment.", GROUP_ENVIRONMENT, false},
    {"settings.", GROUP_SETTINGS, false}, {"view.", GROUP_VIEW, false},
    {"camera.", GROUP_CAMERA, false},
};

static const char *item_name(const struct scene *scene, enum parameter_group group, uint32_t id)
{
    switch (group) {
    case GROUP_LIGHT:
        return scene->lights[id].name;
    case GROUP_MATERIAL:
        return scene->materials[id].name;
    default:
        return scene->nodes[id].name;
    }
}

// A number below the count, else the index of the first item of that name.
static bool find_item(const struct document *document, enum parameter_group group, const char *text,
                      size_t length, uint32_t *out_id)
{
    uint32_t count = document_count(document, group);
    char *end = NULL;
    unsigned long number = length > 0 && text[0] != '-' ? strtoul(text, &end, 10) : 0;
    if (end == text + length && number < count) {
        *out_id = (uint32_t)number;
        return true;
    }
    for (uint32_t i = 0; i < count; i++) {
        const char *name = item_name(document->scene, group, i);
        if (strlen(name) == length && memcmp(name, text, length) == 0) {
            *out_id = i;
            return true;
        }
    }
    return false;
}

static const struct parameter *find_bare(const char *key)
{
    static const enum parameter_group groups[] = {GROUP_SETTINGS, GROUP_VIEW, GROUP_CAMERA};
    for (size_t i = 0; i < sizeof(groups) / sizeof(groups[0]); i++) {
        const struct parameter *parameter = parameter_find(groups[i], key);
        if (parameter)
            return parameter;
    }
    return NULL;
}

static bool find_key(const struct document *document, const char *key,
                     const struct parameter **out_parameter, uint32_t *out_id, struct error *error)
{
    *out_id = 0;
    *out_parameter = find_bare(key);
    for (size_t i = 0; !*out_parameter && i < sizeof(prefixes) / sizeof(prefixes[0]); i++) {
        size_t length = strlen(prefixes[i].prefix);
        if (strncmp(key, prefixes[i].prefix, length) != 0)
            continue;
        const char *name = key + length;
        if (prefixes[i].list) {
            const char *dot = strrchr(name, '.');
            if (!dot)
                return error_set(error, "%s: want %sID.FIELD", key, prefixes[i].prefix);
            if (!find_item(document, prefixes[i].group, name, (size_t)(dot - name), out_id))
                return error_set(error, "%s: the scene has no such %s (it has %u)", key,
                                 parameter_group_names[prefixes[i].group],
                                 document_count(document, prefixes[i].group));
            name = dot + 1;
        }
        *out_parameter = parameter_find(prefixes[i].group, name);
    }
    if (!*out_parameter)
        return error_set(
            error,
            "%s: no such key; want lights.ID.FIELD, materials.ID.FIELD, "
            "nodes.ID.FIELD, environment.FIELD, or a field of settings, view or camera",
            key);
    return true;
}

bool document_set_text(struct scene *scene, struct render_settings *settings,
                       struct view_options *view, const char *key, const char *value,
                       struct error *out_error)
{
    struct document document = {.scene = scene, .settings = settings, .view = view};
    const struct parameter *parameter = NULL;
    uint32_t id = 0;
    if (!find_key(&document, key, &parameter, &id, out_error))
        return false;
    struct rpc_error error;
    struct parameter_value parsed;
    if (!parameter_value_from_text(parameter, value, &parsed, &error) ||
        !document_set(&document, parameter->group, id, &parsed, 1, &error))
        return error_set(out_error, "%s=%.100s: %.380s", key, value, error.message);
    return true;
}
