#include "server/document/document.h"

#include <assert.h>
#include <math.h>
#include <stddef.h>
#include <string.h>

#include <cjson/cJSON.h>

// What the scene keeps in several structs, collected so that every field has one offset.
struct light_record {
    struct scene_light light;
    float position[3];
    float direction[3];
};

struct node_record {
#define PARAMETER(record, name, type, ...) PARAMETER_FIELD(type, name)
#include "protocol/parameters/node.def"
#undef PARAMETER
};

union record {
    struct light_record light;
    struct scene_material material;
    struct node_record node;
    struct scene_environment environment;
    struct render_settings settings;
    struct animation_state animation;
    struct view_options view;
    struct view_camera camera;
};

// Where the table's records lie in the union.
#define LIGHT_FIELD(name)           light.light.name
#define LIGHT_PLACEMENT_FIELD(name) light.name
#define MATERIAL_FIELD(name)        material.name
#define NODE_FIELD(name)            node.name
#define ENVIRONMENT_FIELD(name)     environment.name
#define SETTINGS_FIELD(name)        settings.name
#define ANIMATION_FIELD(name)       animation.name
#define VIEW_FIELD(name)            view.name
#define CAMERA_FIELD(name)          camera.name

// The offset of each parameter's field, in the order of the table.
#define OFFSET(record_name, name) offsetof(union record, record_name##_FIELD(name)),
static const size_t offsets[] = {
#define PARAMETER(record, name, ...) OFFSET(record, name)
#include "protocol/parameters/parameters.def"
#undef PARAMETER
};

// Checks that the field has the type that read_field() and write_field() assume.
#define CHECK_TYPE(record_name, name, type)                                                        \
    _Static_assert(_Generic(&((union record *)0)->record_name##_FIELD(name),                       \
                            PARAMETER_ELEMENT_##type(*) PARAMETER_EXTENT_##type                    \
                            : true, default                                                        \
                            : false),                                                              \
                   "the field has another type than the row: " #record_name "." #name);
#define PARAMETER(record, name, type, ...) CHECK_TYPE(record, name, type)
#include "protocol/parameters/parameters.def"
#undef PARAMETER
_Static_assert(PARAMETER_NAME_BYTES == PROTOCOL_MAX_NAME_BYTES + 1, "names fit");

static void *field_of(const union record *record, const struct parameter *parameter)
{
    return (char *)record + offsets[parameter - parameter_at(0)];
}

static void read_field(const void *field, const struct parameter *parameter,
                       struct parameter_value *out_value)
{
    *out_value = (struct parameter_value){.parameter = parameter};
    switch (parameter->type) {
    case PARAMETER_INT:
    case PARAMETER_ENUM:
        out_value->numbers[0] = *(const uint32_t *)field;
        break;
    case PARAMETER_BOOL:
        out_value->numbers[0] = *(const bool *)field;
        break;
    case PARAMETER_STRING:
        strncpy(out_value->text, field, PROTOCOL_MAX_NAME_BYTES);
        break;
    default:
        for (uint32_t i = 0; i < parameter_component_count(parameter->type); i++)
            out_value->numbers[i] = ((const float *)field)[i];
        break;
    }
}

static void write_field(void *field, const struct parameter_value *value)
{
    switch (value->parameter->type) {
    case PARAMETER_INT:
    case PARAMETER_ENUM:
        *(uint32_t *)field = (uint32_t)value->numbers[0];
        break;
    case PARAMETER_BOOL:
        *(bool *)field = value->numbers[0] != 0.0;
        break;
    case PARAMETER_STRING:
        memcpy(field, value->text, PROTOCOL_MAX_NAME_BYTES + 1);
        break;
    default:
        for (uint32_t i = 0; i < parameter_component_count(value->parameter->type); i++)
            ((float *)field)[i] = (float)value->numbers[i];
        break;
    }
}

static void load_record(const struct document *document, enum parameter_group group, uint32_t id,
                        union record *record)
{
    const struct scene *scene = document->scene;
    memset(record, 0, sizeof(*record));
    switch (group) {
    case GROUP_LIGHT:
        record->light.light = scene->lights[id];
        scene_get_light_placement(scene, id, record->light.position, record->light.direction);
        break;
    case GROUP_MATERIAL:
        record->material = scene->materials[id];
        break;
    case GROUP_NODE:
        memcpy(record->node.name, scene->nodes[id].name, sizeof(record->node.name));
        memcpy(record->node.translation, scene->nodes[id].translation, sizeof(float[3]));
        memcpy(record->node.rotation, scene->nodes[id].rotation, sizeof(float[4]));
        memcpy(record->node.scale, scene->nodes[id].scale, sizeof(float[3]));
        record->node.visible = scene->nodes[id].visible;
        break;
    case GROUP_ENVIRONMENT:
        record->environment = scene->environment;
        break;
    case GROUP_SETTINGS:
        record->settings = *document->settings;
        break;
    case GROUP_ANIMATION:
        record->animation = document->animations[id];
        break;
    case GROUP_VIEW:
        record->view = *document->view;
        break;
    case GROUP_CAMERA:
        record->camera = document->view->camera;
        break;
    case GROUP_COUNT:
        break;
    }
}

static bool names(const struct parameter_value *values, uint32_t count, const char *name)
{
    for (uint32_t i = 0; i < count; i++) {
        if (strcmp(values[i].parameter->name, name) == 0)
            return true;
    }
    return false;
}

static void store_light(struct scene *scene, uint32_t id, const struct light_record *record,
                        bool moved)
{
    scene_set_light(scene, id, &record->light);
    if (moved)
        scene_set_light_placement(scene, id, record->position, record->direction);
}

static void store_node(struct scene *scene, uint32_t id, const struct node_record *record)
{
    struct scene_node *node = &scene->nodes[id];
    memcpy(node->name, record->name, sizeof(node->name));
    scene_set_node_transform(scene, id, record->translation, record->rotation, record->scale);
    if (node->visible != record->visible)
        scene_set_node_visible(scene, id, record->visible);
}

static void store_record(const struct document *document, enum parameter_group group, uint32_t id,
                         const union record *record, bool light_moved)
{
    switch (group) {
    case GROUP_LIGHT:
        store_light(document->scene, id, &record->light, light_moved);
        break;
    case GROUP_MATERIAL:
        scene_set_material(document->scene, id, &record->material);
        break;
    case GROUP_NODE:
        store_node(document->scene, id, &record->node);
        break;
    case GROUP_ENVIRONMENT:
        scene_set_environment(document->scene, &record->environment);
        break;
    case GROUP_SETTINGS:
        *document->settings = record->settings;
        break;
    case GROUP_ANIMATION:
        document->animations[id] = record->animation;
        break;
    case GROUP_VIEW:
        *document->view = record->view;
        break;
    case GROUP_CAMERA:
        document->view->camera = record->camera;
        break;
    case GROUP_COUNT:
        break;
    }
}

#define VECTOR(...)                                                                                \
    {                                                                                              \
        __VA_ARGS__                                                                                \
    }
#define EMPTY ""

void view_options_init(struct view_options *view)
{
    *view = (struct view_options){
#define PARAMETER(record, name, type, range, unit, initial, ...) .name = initial,
#include "protocol/parameters/view.def"
#undef PARAMETER
#define PARAMETER(record, name, type, range, unit, initial, ...) .camera.name = initial,
#include "protocol/parameters/camera.def"
#undef PARAMETER
    };
}

void animation_state_init(struct animation_state *state)
{
    *state = (struct animation_state){
#define PARAMETER(record, name, type, range, unit, initial, ...) .name = initial,
#include "protocol/parameters/animation.def"
#undef PARAMETER
    };
}

uint32_t document_count(const struct document *document, enum parameter_group group)
{
    const struct scene *scene = document->scene;
    switch (group) {
    case GROUP_LIGHT:
        return scene ? scene->light_count : 0;
    case GROUP_MATERIAL:
        return scene ? scene->material_count : 0;
    case GROUP_NODE:
        return scene ? scene->node_count : 0;
    case GROUP_ENVIRONMENT:
        return scene ? 1 : 0;
    case GROUP_SETTINGS:
        return document->settings ? 1 : 0;
    case GROUP_ANIMATION:
        return scene && document->animations ? scene->animation_count : 0;
    default:
        return document->view ? 1 : 0;
    }
}

bool document_has(const struct document *document, enum parameter_group group, uint32_t id,
                  struct rpc_error *out_error)
{
    uint32_t count = document_count(document, group);
    const char *name = parameter_group_names[group];
    if (count == 0)
        return rpc_error_field(out_error, "id", NULL, "id: there is no %s", name);
    if (id >= count) {
        rpc_error_field(out_error, "id", NULL, "id: there is no %s %u; allowed are 0 to %u", name,
                        id, count - 1);
        out_error->has_range = true;
        out_error->max = count - 1;
        return false;
    }
    if ((group == GROUP_LIGHT && document->scene->lights[id].removed) ||
        (group == GROUP_NODE && document->scene->nodes[id].removed))
        return rpc_error_field(out_error, "id", NULL, "id: %s %u was removed", name, id);
    return true;
}

void document_get(const struct document *document, const struct parameter *parameter, uint32_t id,
                  struct parameter_value *out_value)
{
    union record record;
    load_record(document, parameter->group, id, &record);
    read_field(field_of(&record, parameter), parameter, out_value);
}

static void normalize(struct parameter_value *value)
{
    uint32_t count = parameter_component_count(value->parameter->type);
    double length = 0.0;
    for (uint32_t i = 0; i < count; i++)
        length += value->numbers[i] * value->numbers[i];
    length = sqrt(length);
    for (uint32_t i = 0; i < count && length > 0.0; i++)
        value->numbers[i] /= length;
}

// Checks that need more than a single value.
static bool check_record(enum parameter_group group, const union record *record,
                         struct rpc_error *error)
{
    if (group == GROUP_ENVIRONMENT && record->environment.type == SCENE_ENVIRONMENT_EQUIRECT &&
        !record->environment.image)
        return rpc_error_field(error, "type", NULL,
                               "type: equirect needs an image; environment.load with the name of "
                               "one that scene.list names gives it, or --environment FILE");
    if (group == GROUP_SETTINGS && record->settings.cone_step > 0.0f &&
        record->settings.cone_step < CONE_STEP_MIN)
        return rpc_error_field(
            error, "cone_step", NULL, "cone_step: %g is too short; allowed are 0 and %g to %g",
            (double)record->settings.cone_step, (double)CONE_STEP_MIN, (double)CONE_STEP_MAX);
    if (group == GROUP_CAMERA) {
        const struct view_camera *camera = &record->camera;
        float distance = 0.0f;
        for (int i = 0; i < 3; i++)
            distance = fmaxf(distance, fabsf(camera->target[i] - camera->eye[i]));
        if (!(distance > 0.0f))
            return rpc_error_field(error, "target", NULL, "target: it lies in the eye");
    }
    return true;
}

bool document_set(const struct document *document, enum parameter_group group, uint32_t id,
                  struct parameter_value *values, uint32_t value_count, struct rpc_error *out_error)
{
    if (!document_has(document, group, id, out_error))
        return false;
    union record record;
    load_record(document, group, id, &record);
    for (uint32_t i = 0; i < value_count; i++) {
        if (values[i].parameter->flags & PARAMETER_NONZERO)
            normalize(&values[i]);
        write_field(field_of(&record, values[i].parameter), &values[i]);
    }
    if (!check_record(group, &record, out_error))
        return false;
    bool moved = names(values, value_count, "position") || names(values, value_count, "direction");
    store_record(document, group, id, &record, moved);
    return true;
}
