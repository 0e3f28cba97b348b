// Random edits, as many users might make them.
#include <cjson/cJSON.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/document/edit.h"
#include "server/tool/stability/hostile.h"
#include "server/tool/stability/mutation.h"
#include "server/tool/stability/scene_check.h"
#include "server/tool/stability/stage.h"

// Sanitizers take five times as long for each edit.
#ifdef VOXCAST_SANITIZED
#define SEQUENCES 10000u
#else
#define SEQUENCES 100000u
#endif
#define MAX_EDITS 5u
// After this many edits the document starts anew, so that it stays small.
#define SEQUENCES_OF_DOCUMENT 64u
#define CLIENTS               2u
#define MAX_NUMBERS           8192u

// All values of a document that can be set, except lights' positions, which follow their nodes.
struct snapshot_of_values {
    uint32_t count;
    double numbers[MAX_NUMBERS];
};

struct desk {
    struct stability_run *run;
    struct random_numbers random;
    struct scene *scene;
    struct render_settings settings;
    struct view_options view;
    struct document document;
    struct edit_history histories[CLIENTS];
    struct command command;
    struct snapshot_of_values before, after, again;
    uint32_t broken, sequence;
};

static void note(struct desk *desk, const char *broken)
{
    desk->broken += broken != NULL;
    stability_measure(desk->run, desk->broken, "sequence %u: %s", desk->sequence,
                      broken ? broken : "good");
}

// Nested nodes, some with lights, and a few materials.
static bool desk_open(struct desk *desk)
{
    struct scene *scene = desk->scene = scene_create_builtin("cornell", &(struct error){""});
    if (!scene)
        return false;
    uint32_t parent = scene_add_node(scene, "parent", SCENE_NONE);
    uint32_t child = scene_add_node(scene, "child", parent);
    for (int i = 0; i < 3; i++) {
        struct scene_light light;
        scene_light_init(&light, (enum scene_light_type)i, "lamp");
        uint32_t id = scene_add_light(scene, &light, (float[3]){0, 1, 0}, (float[3]){0, -1, 0});
        if (id != SCENE_NONE && i > 0)
            scene->nodes[scene->lights[id].node].parent = i == 1 ? parent : child;
    }
    scene_update_world_transforms(scene);
    render_settings_init(&desk->settings);
    view_options_init(&desk->view);
    desk->document = (struct document){scene, &desk->settings, NULL, &desk->view};
    return true;
}

static void desk_close(struct desk *desk)
{
    for (uint32_t i = 0; i < CLIENTS; i++)
        edit_history_clear(&desk->histories[i]);
    scene_destroy(&desk->scene);
}

static bool is_owned_placement(const struct parameter *parameter)
{
    return parameter->group == GROUP_LIGHT &&
           (strcmp(parameter->name, "position") == 0 || strcmp(parameter->name, "direction") == 0);
}

// Whether the placement of a node may have been computed from that of a light.
static bool is_placement_of_light(const struct scene *scene, const struct parameter *parameter,
                                  uint32_t id)
{
    return parameter->group == GROUP_NODE && parameter->type != PARAMETER_BOOL &&
           parameter->type != PARAMETER_STRING && scene->nodes[id].light != SCENE_NONE;
}

static double number_of_text(const char *text)
{
    uint64_t sum = 0;
    for (; *text; text++)
        sum = sum * 31 + (unsigned char)*text;
    return (double)(sum & 0xffffffffffff);
}

// Where a light is moved, its node may lie beyond the range of its own parameters.
static bool is_finite_and_in_range(const struct parameter_value *value, bool of_light)
{
    const struct parameter *parameter = value->parameter;
    bool has_range = parameter->min < parameter->max && !of_light;
    for (uint32_t i = 0; i < parameter_component_count(parameter->type); i++) {
        double number = value->numbers[i], rounding = 1e-6 * fabs(number);
        if (!isfinite(number) || (has_range && (number < parameter->min - rounding ||
                                                number > parameter->max + rounding)))
            return false;
    }
    return true;
}

// What is broken in the values; NULL for nothing.
static const char *take_values(struct desk *desk, struct snapshot_of_values *out)
{
    const char *broken = NULL;
    out->count = 0;
    for (size_t p = 0; p < parameter_count(); p++) {
        const struct parameter *parameter = parameter_at(p);
        if (parameter->group == GROUP_ANIMATION)
            continue;
        uint32_t ids = document_count(&desk->document, parameter->group);
        for (uint32_t id = 0; id < ids && out->count + 5 < MAX_NUMBERS; id++) {
            struct rpc_error error;
            struct parameter_value value = {.parameter = parameter};
            bool there = document_has(&desk->document, parameter->group, id, &error);
            out->numbers[out->count++] = there;
            if (!there)
                continue;
            document_get(&desk->document, parameter, id, &value);
            bool of_light =
                is_owned_placement(parameter) || is_placement_of_light(desk->scene, parameter, id);
            if (!is_finite_and_in_range(&value, of_light))
                broken = "a value is not finite or beyond its range";
            if (of_light)
                continue;
            for (uint32_t i = 0; i < parameter_component_count(parameter->type); i++)
                out->numbers[out->count++] = value.numbers[i];
            if (parameter->type == PARAMETER_STRING)
                out->numbers[out->count++] = number_of_text(value.text);
        }
    }
    return out->count + 5 < MAX_NUMBERS ? broken : "too many values for this test";
}

// Rotations are normalized each time, which may change their last bits. Added lights stay as
// removed ones, at the end of their lists.
static bool are_same(const struct snapshot_of_values *a, const struct snapshot_of_values *b)
{
    if (a->count != b->count)
        return false;
    for (uint32_t i = 0; i < a->count; i++)
        if (fabs(a->numbers[i] - b->numbers[i]) > 1e-6 * fmax(1.0, fabs(a->numbers[i])))
            return false;
    return true;
}

static void fill_value(struct random_numbers *random, const struct parameter *parameter,
                       struct parameter_value *out_value)
{
    *out_value = (struct parameter_value){.parameter = parameter};
    for (uint32_t i = 0; i < parameter_component_count(parameter->type); i++) {
        double fraction = random_unit(random), low = parameter->min, high = parameter->max;
        switch (random_below(random, 4)) {
        case 0:
            fraction = 0.0;
            break;
        case 1:
            fraction = 1.0;
            break;
        default:
            break;
        }
        double number = low + (high - low) * fraction;
        if (parameter->type == PARAMETER_INT)
            number = round(number);
        if (parameter->type == PARAMETER_BOOL)
            number = random_below(random, 2);
        if (parameter->type == PARAMETER_ENUM)
            number = random_below(random, parameter_value_count(parameter));
        out_value->numbers[i] = number;
    }
    if (parameter->flags & PARAMETER_NONZERO && fabs(out_value->numbers[0]) < 0.01)
        out_value->numbers[0] = 1.0;
    if (parameter->type == PARAMETER_STRING)
        snprintf(out_value->text, sizeof(out_value->text), "name %u", random_below(random, 1000));
}

// Different parameters of a group.
static void fill_values(struct desk *desk, enum parameter_group group)
{
    struct command *command = &desk->command;
    for (size_t p = 0; p < parameter_count() && command->value_count < 6; p++) {
        const struct parameter *parameter = parameter_at(p);
        if (parameter->group == group && random_below(&desk->random, 4) == 0)
            fill_value(&desk->random, parameter, &command->values[command->value_count++]);
    }
}

static void fill_command(struct desk *desk)
{
    static const enum method methods[] = {
        METHOD_LIGHT_ADD,    METHOD_LIGHT_REMOVE,       METHOD_LIGHT_UPDATE,
        METHOD_LIGHT_UPDATE, METHOD_MATERIAL_UPDATE,    METHOD_NODE_UPDATE,
        METHOD_NODE_UPDATE,  METHOD_ENVIRONMENT_UPDATE, METHOD_SETTINGS_UPDATE,
    };
    struct command *command = &desk->command;
    command->value_count = 0;
    command->method = methods[random_below(&desk->random, sizeof(methods) / sizeof(methods[0]))];
    enum parameter_group group = method_get_group(command->method);
    command->target = COMMAND_NO_TARGET;
    if (group != GROUP_COUNT)
        fill_values(desk, group);
    if (command->method == METHOD_LIGHT_REMOVE)
        group = GROUP_LIGHT;
    if (command->method != METHOD_LIGHT_ADD && group <= GROUP_NODE)
        command->target = random_below(&desk->random, document_count(&desk->document, group));
}

// Whether the edit was accepted. A refused edit, such as of a light that is gone, must give a
// reason.
static bool apply(struct desk *desk, uint32_t client)
{
    struct rpc_error error = {0};
    cJSON *result = cJSON_CreateObject(), *edit = NULL;
    bool done = edit_apply(&desk->document, &desk->histories[client], &desk->command, result, &edit,
                           &error);
    if (!done && !error.message[0])
        note(desk, "refused without a reason");
    cJSON_Delete(result);
    cJSON_Delete(edit);
    return done;
}

static void repeat(struct desk *desk, uint32_t client, enum method method, uint32_t count)
{
    for (uint32_t i = 0; i < count; i++) {
        desk->command = (struct command){.method = method, .target = COMMAND_NO_TARGET};
        if (!apply(desk, client))
            note(desk, "an edit could not be taken back or made again");
    }
}

// Edits by one client, undone and redone.
static void run_alone(struct desk *desk, uint32_t client)
{
    uint32_t edits = 1 + random_below(&desk->random, MAX_EDITS), done = 0;
    uint32_t lights = desk->scene->light_count;
    note(desk, take_values(desk, &desk->before));
    for (uint32_t i = 0; i < edits; i++) {
        fill_command(desk);
        done += apply(desk, client);
    }
    note(desk, take_values(desk, &desk->after));
    bool added = desk->scene->light_count > lights; // ids that did not exist before
    repeat(desk, client, METHOD_EDIT_UNDO, done);
    note(desk, take_values(desk, &desk->again));
    if (!added && !are_same(&desk->before, &desk->again))
        note(desk, "taking edits back leaves another document");
    repeat(desk, client, METHOD_EDIT_REDO, done);
    take_values(desk, &desk->again);
    if (!are_same(&desk->after, &desk->again))
        note(desk, "making edits again makes another document");
}

// Both clients edit, undo and redo in any order.
static void run_together(struct desk *desk)
{
    for (uint32_t i = 0; i < 2 * MAX_EDITS; i++) {
        uint32_t client = random_below(&desk->random, CLIENTS);
        fill_command(desk);
        uint32_t kind = random_below(&desk->random, 4);
        if (kind < 2)
            desk->command = (struct command){.method = kind ? METHOD_EDIT_REDO : METHOD_EDIT_UNDO,
                                             .target = COMMAND_NO_TARGET};
        apply(desk, client);
    }
    note(desk, take_values(desk, &desk->after));
}

void hostile_run_edits(struct stability_run *run)
{
    struct desk *desk = calloc(1, sizeof(*desk));
    if (!desk || !desk_open(desk)) {
        stability_fail(run, "out of memory");
        free(desk);
        return;
    }
    desk->run = run;
    for (desk->sequence = 0; desk->sequence < SEQUENCES && !run->failed; desk->sequence++) {
        desk->random.state = desk->sequence;
        if (desk->sequence % 4 == 3)
            run_together(desk);
        else
            run_alone(desk, desk->sequence % CLIENTS);
        note(desk, scene_check(desk->scene));
        if (desk->sequence % SEQUENCES_OF_DOCUMENT != SEQUENCES_OF_DOCUMENT - 1)
            continue;
        desk_close(desk);
        if (!desk_open(desk))
            stability_fail(run, "out of memory");
    }
    desk_close(desk);
    free(desk);
}

// Parameters that are dragged, except choices of how to draw, which other families cover.
static bool is_drawn(const struct parameter *parameter)
{
    return parameter->min < parameter->max && parameter->group != GROUP_ANIMATION &&
           parameter->group != GROUP_VIEW && parameter->type != PARAMETER_INT;
}

static void draw_at(struct stability_view *view, const struct document *document,
                    struct frame_params *params, const struct parameter *parameter, double number)
{
    struct parameter_value before = {.parameter = parameter}, value = {.parameter = parameter};
    struct rpc_error error;
    document_get(document, parameter, 0, &before);
    for (uint32_t i = 0; i < parameter_component_count(parameter->type); i++)
        value.numbers[i] = number;
    if (!document_set(document, parameter->group, 0, &value, 1, &error))
        return;
    params->camera = document->view->camera;
    params->settings = *document->settings;
    stability_view_draw(view, params);
    stability_measure(view->run, (double)view->run->bad_values, "%s.%s at %g",
                      parameter_group_names[parameter->group], parameter->name, number);
    document_set(document, parameter->group, 0, &before, 1, &error);
}

void hostile_run_drawn(struct stability_run *run)
{
    struct stage stage;
    struct stability_view view;
    if (!stage_create(run, &(struct stage_params){0}, &stage))
        return;
    struct frame_params params = stability_params(run);
    params.width = 40;
    params.height = 30;
    struct view_options options;
    view_options_init(&options);
    options.camera = stage.camera;
    struct document document = {stage.scene, &params.settings, NULL, &options};
    struct render_settings settings = params.settings;
    document.settings = &settings;
    bool open = stability_view_open(&view, run, stage.scene);
    for (size_t i = 0; i < parameter_count() && open && !run->failed; i++) {
        if (!is_drawn(parameter_at(i)))
            continue;
        draw_at(&view, &document, &params, parameter_at(i), parameter_at(i)->min);
        draw_at(&view, &document, &params, parameter_at(i), parameter_at(i)->max);
    }
    stability_view_close(&view);
    scene_destroy(&stage.scene);
}
