// Commands of clients: each gets a reply, and edits are reported to all.
#include "server/document/edit_log.h"
#include "server/render/render_internal.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/document/document_json.h"

static bool name_is_taken(struct render_thread *thread, const char *name)
{
    for (uint32_t i = 0; i < FRAME_STREAM_MAX_CLIENTS; i++) {
        if (thread->clients[i].client_id && strcmp(thread->clients[i].name, name) == 0)
            return true;
    }
    return false;
}

static void choose_name(struct render_thread *thread, const char *wanted, uint32_t client_id,
                        char *out, size_t size)
{
    char name[PROTOCOL_MAX_NAME_BYTES + 1];
    if (wanted[0])
        snprintf(name, sizeof(name), "%s", wanted);
    else
        snprintf(name, sizeof(name), "guest-%u", client_id);
    if (name_is_taken(thread, name))
        snprintf(out, size, "%.50s-%u", name, client_id);
    else
        snprintf(out, size, "%s", name);
}

static cJSON *limits_to_json(const struct render_thread_params *params)
{
    cJSON *limits = cJSON_CreateObject();
    cJSON_AddNumberToObject(limits, "message_bytes", params->message_bytes);
    cJSON_AddNumberToObject(limits, "json_depth", PROTOCOL_MAX_JSON_DEPTH);
    cJSON_AddNumberToObject(limits, "json_elements", PROTOCOL_MAX_JSON_ELEMENTS);
    cJSON_AddNumberToObject(limits, "string_bytes", PROTOCOL_MAX_STRING_BYTES);
    cJSON_AddNumberToObject(limits, "name_bytes", PROTOCOL_MAX_NAME_BYTES);
    cJSON_AddNumberToObject(limits, "message_rate", params->message_rate);
    cJSON_AddNumberToObject(limits, "message_burst", 2.0 * params->message_rate);
    cJSON_AddNumberToObject(limits, "unacknowledged_frames", FRAME_STREAM_MAX_UNACKNOWLEDGED);
    cJSON_AddNumberToObject(limits, "clients", params->max_clients);
    cJSON_AddNumberToObject(limits, "width", VIEW_MAX_WIDTH);
    cJSON_AddNumberToObject(limits, "height", VIEW_MAX_HEIGHT);
    cJSON_AddNumberToObject(limits, "thumbnail_edge", PROTOCOL_MAX_THUMBNAIL_EDGE);
    return limits;
}

static void add_revision(const struct render_thread *thread, cJSON *object)
{
    cJSON_AddNumberToObject(object, "epoch", (double)thread->epoch);
    cJSON_AddNumberToObject(object, "revision", (double)thread->revision);
}

static void add_missed_edits(struct render_thread *thread, const struct command *command,
                             cJSON *result)
{
    cJSON *edits = NULL;
    if (command->has_resume && command->resume_epoch == thread->epoch)
        edits = edit_log_since(&thread->log, command->resume_revision, thread->revision);
    cJSON_AddBoolToObject(result, "resync", edits == NULL);
    cJSON_AddItemToObject(result, "edits", edits ? edits : cJSON_CreateArray());
}

static void run_hello(struct render_thread *thread, const struct command *command)
{
    struct rpc_error error;
    if (render_find_client(thread, command->client_id)) {
        rpc_error_set(&error, RPC_INVALID_REQUEST, "session.hello was said already");
        render_reply_error(thread, command, &error);
        return;
    }
    char name[PROTOCOL_MAX_NAME_BYTES + 1];
    choose_name(thread, command->name, command->client_id, name, sizeof(name));
    struct render_client *client = render_add_client(thread, command->client_id);
    if (!client) {
        rpc_error_set(&error, RPC_INTERNAL_ERROR, "no view could be made for this client");
        render_reply_error(thread, command, &error);
        return;
    }
    memcpy(client->name, name, sizeof(name));
    const struct renderer_info *info = renderer_get_info(thread->renderer);
    struct document document = render_document(thread, client);
    cJSON *result = cJSON_CreateObject();
    cJSON_AddNumberToObject(result, "protocol", PROTOCOL_VERSION);
    cJSON_AddStringToObject(result, "server", "voxcastd " VOXCAST_VERSION);
    cJSON_AddNumberToObject(result, "client_id", client->client_id);
    cJSON_AddStringToObject(result, "name", client->name);
    cJSON_AddStringToObject(result, "role", command->viewer ? "viewer" : "editor");
    cJSON *gl = cJSON_AddObjectToObject(result, "gl");
    cJSON_AddStringToObject(gl, "renderer", info->gl_renderer);
    cJSON_AddStringToObject(gl, "version", info->gl_version);
    cJSON_AddBoolToObject(gl, "software", info->software);
    cJSON_AddBoolToObject(result, "ready", thread->scene != NULL);
    add_revision(thread, result);
    add_missed_edits(thread, command, result);
    cJSON_AddItemToObject(result, "view", document_json_group(&document, GROUP_VIEW, 0));
    cJSON_AddItemToObject(result, "camera", document_json_group(&document, GROUP_CAMERA, 0));
    cJSON_AddItemToObject(result, "limits", limits_to_json(&thread->params));
    cJSON_AddItemToObject(result, "parameters", parameters_to_json());
    render_reply(thread, command, result);
    log_write(LOG_INFO, "client_joined client=%u name=\"%s\" viewer=%d", client->client_id,
              client->name, command->viewer);
}

static void run_scene_get(struct render_thread *thread, const struct command *command)
{
    struct document document = render_document(thread, NULL);
    cJSON *result = document_json_scene(&document);
    add_revision(thread, result);
    cJSON_ReplaceItemInObjectCaseSensitive(result, "source",
                                           cJSON_CreateString(thread->scene_label));
    render_reply(thread, command, result);
}

static void run_texture_get(struct render_thread *thread, const struct command *command)
{
    struct rpc_error error;
    cJSON *result = NULL;
    if (command->target >= thread->scene->image_count)
        rpc_error_field(&error, "image", NULL, "image: there is no image %u; the scene has %u",
                        command->target, thread->scene->image_count);
    else if (!(result = document_json_texture(thread->scene, command->target)))
        rpc_error_set(&error, RPC_INTERNAL_ERROR, "the thumbnail could not be made");
    if (result)
        render_reply(thread, command, result);
    else
        render_reply_error(thread, command, &error);
}

// Whether another image is wanted, rather than the same one in another quality.
static bool shows_other_things(const struct view_options *a, const struct view_options *b)
{
    return memcmp(&a->camera, &b->camera, sizeof(a->camera)) != 0 || a->width != b->width ||
           a->height != b->height || a->debug_view != b->debug_view ||
           a->debug_level != b->debug_level || a->debug_face != b->debug_face;
}

static void run_view_or_camera(struct render_thread *thread, struct render_client *client,
                               struct command *command)
{
    struct document document = render_document(thread, client);
    enum parameter_group group = method_get_group(command->method);
    const struct view_options before = client->options;
    struct configuration_override configuration = client->configuration;
    struct rpc_error error;
    if (!render_find_configuration(thread, command, &configuration, &error) ||
        !document_set(&document, group, 0, command->values, command->value_count, &error)) {
        render_reply_error(thread, command, &error);
        return;
    }
    client->configuration = configuration;
    if (shows_other_things(&before, &client->options))
        render_mark_moving(thread, client);
    else
        render_mark_dirty(thread, client);
    cJSON *result;
    if (command->method == METHOD_VIEW_CONFIGURE) {
        result = document_json_group(&document, GROUP_VIEW, 0);
    } else {
        if (command->has_revision)
            client->camera_revision = command->revision;
        result = cJSON_CreateObject();
        cJSON_AddNumberToObject(result, "revision", (double)client->camera_revision);
    }
    render_reply(thread, command, result);
}

static void run_pick(struct render_thread *thread, const struct render_client *client,
                     const struct command *command)
{
    const struct view_options *view = &client->options;
    struct ray_hit hit;
    cJSON *result = cJSON_CreateObject();
    bool found = renderer_pick(thread->renderer, &view->camera, view->width, view->height,
                               (float)command->x, (float)command->y, &hit);
    cJSON_AddBoolToObject(result, "hit", found);
    if (found) {
        cJSON_AddNumberToObject(result, "node", hit.node);
        cJSON_AddNumberToObject(result, "mesh", thread->scene->primitives[hit.primitive].mesh);
        cJSON_AddNumberToObject(result, "primitive", hit.primitive);
        cJSON_AddNumberToObject(result, "triangle", hit.triangle);
        cJSON_AddNumberToObject(result, "material", hit.material);
        cJSON_AddNumberToObject(result, "distance", hit.distance);
        cJSON_AddItemToObject(result, "position", cJSON_CreateFloatArray(hit.position, 3));
        cJSON_AddItemToObject(result, "normal", cJSON_CreateFloatArray(hit.normal, 3));
    }
    render_reply(thread, command, result);
}

static cJSON *superseded_to_json(const struct command *command)
{
    cJSON *list = cJSON_CreateArray();
    for (uint32_t i = 0; i < command->superseded_count; i++)
        cJSON_AddItemToArray(list, cJSON_CreateNumber((double)command->superseded[i]));
    return list;
}

static void broadcast_edit(struct render_thread *thread, const struct render_client *client,
                           const struct command *command, cJSON *edit)
{
    cJSON_AddNumberToObject(edit, "revision", (double)thread->revision);
    if (command->has_edit_id)
        cJSON_AddNumberToObject(edit, "edit_id", (double)command->edit_id);
    if (command->superseded_count > 0)
        cJSON_AddItemToObject(edit, "superseded", superseded_to_json(command));
    if (command->transient)
        cJSON_AddTrueToObject(edit, "transient");
    cJSON *params = cJSON_CreateObject();
    add_revision(thread, params);
    cJSON_AddItemToObject(params, "author", render_author(client));
    cJSON *edits = cJSON_AddArrayToObject(params, "edits");
    cJSON_AddItemToArray(edits, cJSON_Duplicate(edit, true));
    outbox_post(thread->params.outbox, OUTBOX_TO_ALL,
                rpc_write_notification("scene.changed", params));
    cJSON_AddItemToObject(edit, "author", render_author(client));
    edit_log_add(&thread->log, thread->revision, edit);
}

void render_publish_edit(struct render_thread *thread, struct render_client *client,
                         const struct command *command, cJSON *edit)
{
    // Slow loads may finish after later edits.
    if (client && command->has_edit_id && command->edit_id > client->edit_id)
        client->edit_id = command->edit_id;
    thread->revision++;
    pthread_mutex_lock(&thread->status_mutex);
    thread->status.revision = thread->revision;
    pthread_mutex_unlock(&thread->status_mutex);
    broadcast_edit(thread, client, command, edit);
    render_mark_moving(thread, NULL);
}

static void run_edit(struct render_thread *thread, struct render_client *client,
                     struct command *command)
{
    struct document document = render_document(thread, NULL);
    struct rpc_error error;
    cJSON *edit = NULL;
    cJSON *result = cJSON_CreateObject();
    if (!edit_apply(&document, &client->history, command, result, &edit, &error)) {
        cJSON_Delete(result);
        render_reply_error(thread, command, &error);
        return;
    }
    if (command->has_edit_id)
        client->edit_id = command->edit_id;
    if (edit)
        render_publish_edit(thread, client, command, edit);
    cJSON_AddNumberToObject(result, "revision", (double)thread->revision);
    if (command->has_edit_id)
        cJSON_AddNumberToObject(result, "edit_id", (double)command->edit_id);
    cJSON_AddItemToObject(result, "superseded", superseded_to_json(command));
    render_reply(thread, command, result);
}

static bool works_without_scene(enum method method)
{
    return method == METHOD_SESSION_HELLO || method == METHOD_SCENE_LIST ||
           method == METHOD_SCENE_LOAD || method == METHOD_CAMERA_SET ||
           method == METHOD_VIEW_CONFIGURE;
}

void render_run_command(struct render_thread *thread, struct command *command)
{
    struct render_client *client = render_find_client(thread, command->client_id);
    // A client that has gone while its command waited gets no reply.
    if (!client && command->method != METHOD_SESSION_HELLO)
        return;
    if (!thread->scene && !works_without_scene(command->method)) {
        struct rpc_error error;
        rpc_error_set(&error, RPC_NOT_READY, "no scene is shown yet");
        render_reply_error(thread, command, &error);
        return;
    }
    switch (command->method) {
    case METHOD_SESSION_HELLO:
        run_hello(thread, command);
        break;
    case METHOD_SCENE_GET:
        run_scene_get(thread, command);
        break;
    case METHOD_SCENE_LIST:
        render_run_scene_list(thread, command);
        break;
    case METHOD_SCENE_LOAD:
        render_run_scene_load(thread, command);
        break;
    case METHOD_ENVIRONMENT_LOAD:
        render_run_environment_load(thread, command);
        break;
    case METHOD_TEXTURE_GET:
        run_texture_get(thread, command);
        break;
    case METHOD_CAMERA_SET:
    case METHOD_VIEW_CONFIGURE:
        run_view_or_camera(thread, client, command);
        break;
    case METHOD_PICK:
        run_pick(thread, client, command);
        break;
    case METHOD_ACCURACY_START:
        render_run_accuracy_start(thread, client, command);
        break;
    case METHOD_ACCURACY_CANCEL:
        render_run_accuracy_cancel(thread, command);
        break;
    default:
        run_edit(thread, client, command);
        break;
    }
}
