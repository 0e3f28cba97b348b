#include "server/document/edit.h"

#include <stdlib.h>
#include <string.h>

#include "server/document/document_json.h"

static void free_step(struct edit_step *step)
{
    if (step) {
        environment_image_release(&step->image_before);
        environment_image_release(&step->image_after);
    }
    free(step);
}

void edit_history_clear(struct edit_history *history)
{
    for (uint32_t i = 0; i < history->count; i++)
        free_step(history->steps[i]);
    memset(history, 0, sizeof(*history));
}

static void drop_redo(struct edit_history *history)
{
    while (history->count > history->position)
        free_step(history->steps[--history->count]);
}

static bool continues(const struct edit_step *step, const struct edit_step *next)
{
    if (!step->open || step->method != next->method || step->target != next->target ||
        step->value_count != next->value_count)
        return false;
    for (uint32_t i = 0; i < step->value_count; i++) {
        if (step->after[i].parameter != next->after[i].parameter)
            return false;
    }
    return true;
}

static void drop_oldest(struct edit_history *history)
{
    free_step(history->steps[0]);
    history->count--;
    memmove(&history->steps[0], &history->steps[1], history->count * sizeof(history->steps[0]));
    history->position = history->count;
}

// Bytes of the images that the steps keep, without the one that the newest step has set.
static uint64_t image_bytes(const struct edit_history *history)
{
    uint64_t bytes = 0;
    for (uint32_t i = 0; i < history->count; i++) {
        const struct environment_image *image = history->steps[i]->image_before;
        bytes += image ? (uint64_t)image->width * image->height * sizeof(float[3]) : 0;
    }
    return bytes;
}

// Takes over `step`. NULL, from a failed allocation, loses an undo step.
static void record(struct edit_history *history, struct edit_step *step)
{
    if (!step)
        return;
    drop_redo(history);
    struct edit_step *top = history->count > 0 ? history->steps[history->count - 1] : NULL;
    if (top && continues(top, step)) {
        memcpy(top->after, step->after, sizeof(top->after));
        top->open = step->open;
        free_step(step);
        return;
    }
    if (history->count == EDIT_HISTORY_STEPS)
        drop_oldest(history);
    history->steps[history->count++] = step;
    history->position = history->count;
    while (history->count > 1 && image_bytes(history) > EDIT_HISTORY_IMAGE_BYTES)
        drop_oldest(history);
}

// All values of a light, so that undo can bring it back.
static void capture_light(const struct document *document, struct edit_step *step,
                          struct parameter_value values[COMMAND_MAX_VALUES])
{
    struct rpc_error error;
    step->value_count = 0;
    for (size_t i = 0; i < parameter_count() && step->value_count < COMMAND_MAX_VALUES; i++)
        if (parameter_at(i)->group == GROUP_LIGHT &&
            document_has(document, GROUP_LIGHT, step->target, &error))
            document_get(document, parameter_at(i), step->target, &values[step->value_count++]);
}

static struct edit_step *create_step(const struct document *document, const struct command *command)
{
    struct edit_step *step = calloc(1, sizeof(*step));
    if (!step)
        return NULL;
    step->method = command->method;
    step->target = command->target;
    step->open = command->transient;
    enum parameter_group group = method_get_group(command->method);
    if (command->method == METHOD_LIGHT_REMOVE)
        capture_light(document, step, step->before);
    if (command->method == METHOD_LIGHT_ADD || group == GROUP_COUNT)
        return step;
    uint32_t id = command->target == COMMAND_NO_TARGET ? 0 : command->target;
    step->value_count = command->value_count;
    for (uint32_t i = 0; i < command->value_count; i++)
        document_get(document, command->values[i].parameter, id, &step->before[i]);
    return step;
}

static bool is_below(const struct scene *scene, uint32_t node, uint32_t ancestor)
{
    while (node != SCENE_NONE && node != ancestor)
        node = scene->nodes[node].parent;
    return node == ancestor;
}

// The new positions of the lights below a node that moved.
static void add_moved_lights(cJSON *edit, const struct scene *scene, uint32_t node)
{
    cJSON *lights = NULL;
    for (uint32_t i = 0; i < scene->light_count; i++) {
        if (scene->lights[i].removed || !is_below(scene, scene->lights[i].node, node))
            continue;
        float position[3], direction[3];
        scene_get_light_placement(scene, i, position, direction);
        if (!lights)
            lights = cJSON_AddArrayToObject(edit, "lights");
        cJSON *light = cJSON_CreateObject();
        cJSON_AddNumberToObject(light, "id", i);
        cJSON_AddItemToObject(light, "position", cJSON_CreateFloatArray(position, 3));
        cJSON_AddItemToObject(light, "direction", cJSON_CreateFloatArray(direction, 3));
        cJSON_AddItemToArray(lights, light);
    }
}

static void add_moved_node(cJSON *edit, const struct scene *scene, uint32_t id)
{
    const struct scene_node *node = &scene->nodes[id];
    cJSON *nodes = cJSON_AddArrayToObject(edit, "nodes");
    cJSON *item = cJSON_CreateObject();
    cJSON_AddNumberToObject(item, "id", id);
    cJSON_AddItemToObject(item, "translation", cJSON_CreateFloatArray(node->translation, 3));
    cJSON_AddItemToObject(item, "rotation", cJSON_CreateFloatArray(node->rotation, 4));
    cJSON_AddItemToArray(nodes, item);
}

static bool moves_light(const struct command *command)
{
    for (uint32_t i = 0; i < command->value_count; i++) {
        const char *name = command->values[i].parameter->name;
        if (strcmp(name, "position") == 0 || strcmp(name, "direction") == 0)
            return true;
    }
    return false;
}

static cJSON *create_edit(const struct command *command, uint32_t id)
{
    cJSON *edit = cJSON_CreateObject();
    cJSON_AddStringToObject(edit, "method", method_name(command->method));
    if (id != COMMAND_NO_TARGET)
        cJSON_AddNumberToObject(edit, "id", id);
    return edit;
}

static cJSON *update(const struct document *document, struct command *command,
                     struct rpc_error *error)
{
    enum parameter_group group = method_get_group(command->method);
    uint32_t id = command->target == COMMAND_NO_TARGET ? 0 : command->target;
    if (!document_set(document, group, id, command->values, command->value_count, error))
        return NULL;
    if (group == GROUP_ANIMATION)
        scene_animate(document->scene, id, document->animations[id].time_s);
    cJSON *edit = create_edit(command, command->target);
    cJSON_AddItemToObject(edit, "set", document_json_values(command->values, command->value_count));
    if (group == GROUP_NODE)
        add_moved_lights(edit, document->scene, id);
    if (group == GROUP_LIGHT && moves_light(command)) {
        add_moved_node(edit, document->scene, document->scene->lights[id].node);
        add_moved_lights(edit, document->scene, document->scene->lights[id].node);
    }
    return edit;
}

static cJSON *describe_added_light(const struct document *document, const struct command *command,
                                   uint32_t id)
{
    cJSON *edit = create_edit(command, id);
    cJSON_AddItemToObject(edit, "light", document_json_light(document, id));
    cJSON_AddItemToObject(edit, "node",
                          document_json_node(document, document->scene->lights[id].node));
    return edit;
}

static bool is_set(const struct document *document, uint32_t id,
                   const struct parameter_value *value)
{
    struct parameter_value now = {0};
    document_get(document, value->parameter, id, &now);
    return memcmp(now.numbers, value->numbers, sizeof(now.numbers)) == 0 &&
           strcmp(now.text, value->text) == 0;
}

// Restores a removed light under its id with the values of the command: another light may have used
// the id since. Values that are equal already are left alone, since setting a placement rounds.
static bool restore_light(const struct document *document, struct command *command,
                          struct rpc_error *error)
{
    uint32_t id = command->target, changed = 0;
    if (!scene_restore_light(document->scene, id))
        return rpc_error_set(error, RPC_INVALID_PARAMS, "another light has the place of light %u",
                             id);
    for (uint32_t i = 0; i < command->value_count; i++)
        if (!is_set(document, id, &command->values[i]))
            command->values[changed++] = command->values[i];
    if (changed == 0 || document_set(document, GROUP_LIGHT, id, command->values, changed, error))
        return true;
    scene_remove_light(document->scene, id);
    return false;
}

static cJSON *add_light(const struct document *document, struct command *command, cJSON *result,
                        struct rpc_error *error)
{
    struct scene *scene = document->scene;
    if (!scene) {
        rpc_error_set(error, RPC_NOT_READY, "no scene is shown yet");
        return NULL;
    }
    uint32_t id = command->target; // of a removed light that an undo or redo brings back
    if (id != COMMAND_NO_TARGET) {
        if (!restore_light(document, command, error))
            return NULL;
    } else {
        struct scene_light light;
        scene_light_init(&light, SCENE_LIGHT_POINT, "light");
        id = scene_add_light(scene, &light, (float[3]){0, 0, 0}, (float[3]){0, -1, 0});
        if (id == SCENE_NONE) {
            rpc_error_set(error, RPC_INVALID_PARAMS, "the scene is full: %u lights",
                          SCENE_MAX_LIGHTS);
            return NULL;
        }
        scene_update_world_transforms(scene);
        if (!document_set(document, GROUP_LIGHT, id, command->values, command->value_count,
                          error)) {
            scene_remove_light(scene, id);
            return NULL;
        }
        command->target = id;
    }
    cJSON_AddNumberToObject(result, "id", id);
    cJSON_AddNumberToObject(result, "node", scene->lights[id].node);
    return describe_added_light(document, command, id);
}

static cJSON *remove_light(const struct document *document, const struct command *command,
                           struct rpc_error *error)
{
    if (!document_has(document, GROUP_LIGHT, command->target, error))
        return NULL;
    scene_remove_light(document->scene, command->target);
    return create_edit(command, command->target);
}

static cJSON *apply(const struct document *document, struct command *command, cJSON *result,
                    struct rpc_error *error)
{
    if (command->method == METHOD_LIGHT_ADD)
        return add_light(document, command, result, error);
    if (command->method == METHOD_LIGHT_REMOVE)
        return remove_light(document, command, error);
    return update(document, command, error);
}

static enum method opposite(enum method method)
{
    if (method == METHOD_LIGHT_ADD)
        return METHOD_LIGHT_REMOVE;
    return method == METHOD_LIGHT_REMOVE ? METHOD_LIGHT_ADD : method;
}

static void get_environment_type(const struct document *document, struct parameter_value *value)
{
    document_get(document, parameter_find(GROUP_ENVIRONMENT, "type"), 0, value);
}

// `type` is that of parameters; the image may be NULL. Returns the edit.
static cJSON *set_environment(const struct document *document, struct environment_image *image,
                              const struct parameter_value *type)
{
    struct scene_environment environment = document->scene->environment;
    if (environment.image != image)
        environment.image = environment_image_retain(image);
    environment.type = (enum scene_environment_type)type->numbers[0];
    scene_set_environment(document->scene, &environment);
    cJSON *edit = cJSON_CreateObject();
    cJSON_AddStringToObject(edit, "method", method_name(METHOD_ENVIRONMENT_LOAD));
    cJSON_AddItemToObject(edit, "name",
                          image ? cJSON_CreateString(image->name) : cJSON_CreateNull());
    cJSON_AddItemToObject(edit, "set", document_json_values(type, 1));
    return edit;
}

cJSON *edit_load_environment(const struct document *document, struct edit_history *history,
                             struct environment_image *image)
{
    struct edit_step *step = history ? calloc(1, sizeof(*step)) : NULL;
    struct parameter_value type = {0};
    get_environment_type(document, &type);
    if (step) {
        step->method = METHOD_ENVIRONMENT_LOAD;
        step->target = COMMAND_NO_TARGET;
        step->value_count = 1;
        step->before[0] = type;
        step->image_before = environment_image_retain(document->scene->environment.image);
        step->image_after = environment_image_retain(image);
    }
    type.numbers[0] = SCENE_ENVIRONMENT_EQUIRECT;
    if (step) {
        step->after[0] = type;
        record(history, step);
    }
    return set_environment(document, image, &type);
}

// Makes a command of a step and applies it, forwards or backwards.
static bool replay(const struct document *document, const struct edit_step *step, bool backwards,
                   cJSON *result, cJSON **out_edit, struct rpc_error *error)
{
    if (step->method == METHOD_ENVIRONMENT_LOAD) {
        *out_edit = backwards ? set_environment(document, step->image_before, &step->before[0])
                              : set_environment(document, step->image_after, &step->after[0]);
        cJSON_AddStringToObject(result, "method", method_name(step->method));
        return true;
    }
    struct command *command = calloc(1, sizeof(*command));
    if (!command)
        return rpc_error_set(error, RPC_INTERNAL_ERROR, "out of memory");
    command->method = backwards ? opposite(step->method) : step->method;
    command->target = step->target;
    command->value_count = step->value_count;
    memcpy(command->values, backwards ? step->before : step->after, sizeof(command->values));
    *out_edit = apply(document, command, result, error);
    free(command);
    if (*out_edit)
        cJSON_AddStringToObject(result, "method",
                                cJSON_GetObjectItem(*out_edit, "method")->valuestring);
    return *out_edit != NULL;
}

static bool undo_or_redo(const struct document *document, struct edit_history *history,
                         bool backwards, cJSON *result, cJSON **out_edit, struct rpc_error *error)
{
    *out_edit = NULL;
    if (backwards ? history->position == 0 : history->position == history->count) {
        cJSON_AddNullToObject(result, "method");
        return true;
    }
    // A step that cannot be replayed, because another client removed what it changed, is skipped.
    uint32_t step = backwards ? --history->position : history->position++;
    struct edit_step *it = history->steps[step];
    it->open = false;
    if (it->method == METHOD_LIGHT_ADD && backwards)
        capture_light(document, it, it->after);
    if (it->method == METHOD_LIGHT_REMOVE && !backwards)
        capture_light(document, it, it->before);
    return replay(document, it, backwards, result, out_edit, error);
}

bool edit_apply(const struct document *document, struct edit_history *history,
                struct command *command, cJSON *result, cJSON **out_edit,
                struct rpc_error *out_error)
{
    if (command->method == METHOD_EDIT_UNDO || command->method == METHOD_EDIT_REDO)
        return undo_or_redo(document, history, command->method == METHOD_EDIT_UNDO, result,
                            out_edit, out_error);
    enum parameter_group group =
        command->method == METHOD_LIGHT_REMOVE ? GROUP_LIGHT : method_get_group(command->method);
    uint32_t id = command->target == COMMAND_NO_TARGET ? 0 : command->target;
    if (command->method != METHOD_LIGHT_ADD && !document_has(document, group, id, out_error))
        return false;
    struct edit_step *step = create_step(document, command);
    *out_edit = apply(document, command, result, out_error);
    if (!*out_edit) {
        free_step(step);
        return false;
    }
    if (step) {
        step->target = command->target;
        memcpy(step->after, command->values, sizeof(step->after));
    }
    record(history, step);
    return true;
}
