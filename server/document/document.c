#include "server/document/document.h"

#include <assert.h>
#include <math.h>
#include <stddef.h>
#include <string.h>

#include <cjson/cJSON.h>

// Things that are spread over the scene, gathered so that every field has one place.
struct light_record {
    struct scene_light light;
    float position[3];
    float direction[3];
};

struct node_record {
    char name[64];
    float translation[3];
    float rotation[4];
    float scale[3];
    bool visible;
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

// Where the field of a parameter lies in the record of its group. Its type there follows from the
// parameter's: float[], uint32_t, bool, an enum or char[64].
struct binding {
    enum parameter_group group;
    const char *name;
    size_t offset;
};

#define LIGHT(field)                                                                               \
    {                                                                                              \
        GROUP_LIGHT, #field, offsetof(struct light_record, light.field)                            \
    }
#define LIGHT_POSITION(field)                                                                      \
    {                                                                                              \
        GROUP_LIGHT, #field, offsetof(struct light_record, field)                                  \
    }
#define MATERIAL(field)                                                                            \
    {                                                                                              \
        GROUP_MATERIAL, #field, offsetof(struct scene_material, field)                             \
    }
#define NODE(field)                                                                                \
    {                                                                                              \
        GROUP_NODE, #field, offsetof(struct node_record, field)                                    \
    }
#define ENVIRONMENT(field)                                                                         \
    {                                                                                              \
        GROUP_ENVIRONMENT, #field, offsetof(struct scene_environment, field)                       \
    }
#define SETTINGS(field)                                                                            \
    {                                                                                              \
        GROUP_SETTINGS, #field, offsetof(struct render_settings, field)                            \
    }
#define ANIMATION(field)                                                                           \
    {                                                                                              \
        GROUP_ANIMATION, #field, offsetof(struct animation_state, field)                           \
    }
#define VIEW(field)                                                                                \
    {                                                                                              \
        GROUP_VIEW, #field, offsetof(struct view_options, field)                                   \
    }
#define CAMERA(field)                                                                              \
    {                                                                                              \
        GROUP_CAMERA, #field, offsetof(struct view_camera, field)                                  \
    }

static const struct binding bindings[] = {
    LIGHT(name),
    LIGHT(type),
    LIGHT(enabled),
    LIGHT(casts_shadow),
    LIGHT(color),
    LIGHT(intensity),
    LIGHT(range_m),
    LIGHT(inner_cone_rad),
    LIGHT(outer_cone_rad),
    LIGHT(radius_m),
    LIGHT_POSITION(position),
    LIGHT_POSITION(direction),
    MATERIAL(name),
    MATERIAL(shading),
    MATERIAL(alpha_mode),
    MATERIAL(alpha_cutoff),
    MATERIAL(double_sided),
    MATERIAL(base_color),
    MATERIAL(metallic),
    MATERIAL(roughness),
    MATERIAL(normal_scale),
    MATERIAL(occlusion_strength),
    MATERIAL(emissive),
    MATERIAL(emissive_strength),
    MATERIAL(ior),
    MATERIAL(specular),
    MATERIAL(specular_color),
    MATERIAL(transmission),
    MATERIAL(thickness_m),
    MATERIAL(attenuation_distance_m),
    MATERIAL(attenuation_color),
    NODE(name),
    NODE(translation),
    NODE(rotation),
    NODE(scale),
    NODE(visible),
    ENVIRONMENT(type),
    ENVIRONMENT(intensity),
    ENVIRONMENT(color),
    ENVIRONMENT(horizon_color),
    ENVIRONMENT(ground_color),
    ENVIRONMENT(rotation_rad),
    SETTINGS(gi_method),
    SETTINGS(voxel_resolution),
    SETTINGS(voxel_directions),
    SETTINGS(clip_levels),
    SETTINGS(cone_set),
    SETTINGS(cone_step),
    SETTINGS(gather_mode),
    SETTINGS(bounces),
    SETTINGS(indirect_intensity),
    SETTINGS(ambient_occlusion),
    SETTINGS(soft_shadows),
    SETTINGS(indirect_specular),
    SETTINGS(refraction),
    SETTINGS(environment_light),
    SETTINGS(voxelize_every_frame),
    SETTINGS(levels_per_frame),
    SETTINGS(tonemap),
    SETTINGS(exposure_mode),
    SETTINGS(exposure_ev),
    SETTINGS(gamma),
    SETTINGS(shading_model),
    SETTINGS(shadows),
    SETTINGS(force_all_effects),
    ANIMATION(playing),
    ANIMATION(time_s),
    ANIMATION(speed),
    ANIMATION(loop),
    VIEW(width),
    VIEW(height),
    VIEW(quality),
    VIEW(adaptive),
    VIEW(target_frame_ms),
    VIEW(debug_view),
    VIEW(debug_level),
    VIEW(debug_face),
    VIEW(paused),
    VIEW(configuration),
    CAMERA(eye),
    CAMERA(target),
    CAMERA(up),
    CAMERA(fov_y_rad),
};

static size_t find_offset(const struct parameter *parameter)
{
    size_t count = sizeof(bindings) / sizeof(bindings[0]);
    size_t i = 0;
    while (i < count && (bindings[i].group != parameter->group ||
                         strcmp(bindings[i].name, parameter->name) != 0))
        i++;
    assert(i < count); // a test holds table and bindings together
    return bindings[i].offset;
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

void view_options_init(struct view_options *view)
{
    *view = (struct view_options){
        .width = 640,
        .height = 360,
        .quality = QUALITY_FINAL,
        .adaptive = true,
        .target_frame_ms = 100,
        .debug_view = DEBUG_VIEW_FINAL,
        .camera = {.eye = {0, 0, 5}, .up = {0, 1, 0}, .fov_y_rad = 0.785398f},
    };
}

void animation_state_init(struct animation_state *state)
{
    *state = (struct animation_state){.speed = 1.0f, .loop = true};
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
    read_field((const char *)&record + find_offset(parameter), parameter, out_value);
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

// What no single value can tell.
static bool check_record(enum parameter_group group, const union record *record,
                         struct rpc_error *error)
{
    if (group == GROUP_ENVIRONMENT && record->environment.type == SCENE_ENVIRONMENT_EQUIRECT &&
        !record->environment.pixels)
        return rpc_error_field(error, "type", NULL,
                               "type: equirect needs an environment picture in the scene");
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
        write_field((char *)&record + find_offset(values[i].parameter), &values[i]);
    }
    if (!check_record(group, &record, out_error))
        return false;
    bool moved = names(values, value_count, "position") || names(values, value_count, "direction");
    store_record(document, group, id, &record, moved);
    return true;
}
