// Loading, swapping and reloading scenes.
#include "server/document/edit_log.h"
#include "server/render/render_internal.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/document/document_json.h"

#define MAX_LISTED_SCENES 1000u

void render_reset_camera(const struct scene *scene, struct view_camera *camera)
{
    double low[3], high[3];
    if (scene->camera_count > 0) {
        scene_get_camera_placement(scene, 0, camera->eye, camera->target, camera->up);
        camera->fov_y_rad = scene->cameras[0].fov_y_rad;
        return;
    }
    *camera = (struct view_camera){.eye = {0, 0, 5}, .up = {0, 1, 0}, .fov_y_rad = 0.785398f};
    if (!scene_bounds(scene, low, high))
        return;
    double radius = 0.0;
    for (int i = 0; i < 3; i++)
        radius += (high[i] - low[i]) * (high[i] - low[i]) / 4.0;
    double distance = fmax(sqrt(radius), 1e-3) / sin(camera->fov_y_rad / 2.0);
    const double direction[3] = {0.41, 0.33, 0.85}; // unit: from the front, a little above
    for (int i = 0; i < 3; i++) {
        camera->target[i] = (float)((low[i] + high[i]) / 2.0);
        camera->eye[i] = (float)((low[i] + high[i]) / 2.0 + distance * direction[i]);
    }
}

void render_start_load(struct render_thread *thread, const char *source, const char *label,
                       const struct command *command)
{
    char *copy = strdup(source);
    const char *environment =
        command || thread->client_chose_scene ? NULL : thread->params.environment;
    if (!copy || !scene_loader_start(thread->loader, copy, environment)) {
        free(copy);
        struct rpc_error error;
        rpc_error_set(&error, RPC_BUSY, "another scene is being loaded");
        if (command)
            render_reply_error(thread, command, &error);
        else
            thread->reload_wanted = true;
        return;
    }
    free(thread->load_source);
    thread->load_source = copy;
    snprintf(thread->load_label, sizeof(thread->load_label), "%s", label);
    thread->load_client_id = command ? command->client_id : 0;
    thread->load_id = command ? command->id : (struct rpc_id){""};
}

void render_run_scene_load(struct render_thread *thread, const struct command *command)
{
    struct error error;
    char *path = scene_loader_resolve(thread->params.scene_dir, command->source, &error);
    if (!path) {
        struct rpc_error reply;
        rpc_error_field(&reply, "source", NULL, "source: %s", error.message);
        render_reply_error(thread, command, &reply);
        return;
    }
    render_start_load(thread, path, command->source, command);
    free(path);
}

void render_run_scene_list(struct render_thread *thread, const struct command *command)
{
    cJSON *result = cJSON_CreateObject();
    cJSON *scenes = cJSON_AddArrayToObject(result, "scenes");
    for (uint32_t i = 0; scene_builtin_name(i); i++) {
        char source[128];
        snprintf(source, sizeof(source), "builtin:%s", scene_builtin_name(i));
        cJSON *item = cJSON_CreateObject();
        cJSON_AddStringToObject(item, "source", source);
        cJSON_AddStringToObject(item, "description", scene_builtin_description(i));
        cJSON_AddItemToArray(scenes, item);
    }
    char **sources = calloc(MAX_LISTED_SCENES, sizeof(*sources));
    uint32_t count =
        sources ? scene_loader_list(thread->params.scene_dir, sources, MAX_LISTED_SCENES) : 0;
    for (uint32_t i = 0; i < count; i++) {
        cJSON *item = cJSON_CreateObject();
        cJSON_AddStringToObject(item, "source", sources[i]);
        cJSON_AddStringToObject(item, "description", "");
        cJSON_AddItemToArray(scenes, item);
        free(sources[i]);
    }
    count = sources ? scene_loader_list_environments(thread->params.scene_dir, sources,
                                                     MAX_LISTED_SCENES)
                    : 0;
    cJSON *environments = cJSON_AddArrayToObject(result, "environments");
    for (uint32_t i = 0; i < count; i++) {
        cJSON *item = cJSON_CreateObject();
        cJSON_AddStringToObject(item, "name", sources[i]);
        cJSON_AddItemToArray(environments, item);
        free(sources[i]);
    }
    free(sources);
    render_reply(thread, command, result);
}

static void send_loaded(struct render_thread *thread, bool other_source)
{
    struct render_client *author = render_find_client(thread, thread->load_client_id);
    for (uint32_t i = 0; i < FRAME_STREAM_MAX_CLIENTS; i++) {
        struct render_client *client = &thread->clients[i];
        if (!client->client_id)
            continue;
        cJSON *params = cJSON_CreateObject();
        cJSON_AddNumberToObject(params, "epoch", (double)thread->epoch);
        cJSON_AddNumberToObject(params, "revision", (double)thread->revision);
        cJSON_AddStringToObject(params, "source", thread->scene_label);
        cJSON_AddItemToObject(params, "author", render_author(author));
        if (other_source) {
            render_reset_camera(thread->scene, &client->options.camera);
            struct document document = render_document(thread, client);
            cJSON_AddItemToObject(params, "camera",
                                  document_json_group(&document, GROUP_CAMERA, 0));
        }
        outbox_post(thread->params.outbox, client->client_id,
                    rpc_write_notification("scene.loaded", params));
    }
}

// `scene.get` reports the same texts to clients.
static void log_warnings(const struct render_thread *thread)
{
    for (uint32_t i = 0; i < thread->scene->warning_count; i++)
        log_write(LOG_WARN, "scene_warning source=\"%s\" text=\"%s\"", thread->scene_label,
                  thread->scene->warnings[i]);
}

// Shows the scene and frees the old one. On failure the old one stays and `scene` is freed.
static bool swap_scene(struct render_thread *thread, struct scene *scene, struct error *error)
{
    struct animation_state *animations = calloc(scene->animation_count + 1, sizeof(*animations));
    if (!animations || !renderer_set_scene(thread->renderer, scene, error)) {
        free(animations);
        scene_destroy(&scene);
        return false;
    }
    for (uint32_t i = 0; i < scene->animation_count; i++)
        animation_state_init(&animations[i]);
    bool other_source = !thread->scene || !scene->source_path || !thread->scene->source_path ||
                        strcmp(scene->source_path, thread->scene->source_path) != 0;
    scene_destroy(&thread->scene);
    free(thread->animations);
    thread->scene = scene;
    thread->animations = animations;
    thread->client_chose_scene = thread->client_chose_scene || thread->load_client_id != 0;
    thread->epoch++;
    thread->revision++;
    snprintf(thread->scene_label, sizeof(thread->scene_label), "%s", thread->load_label);
    edit_log_clear(&thread->log);
    for (uint32_t i = 0; i < FRAME_STREAM_MAX_CLIENTS; i++) {
        edit_history_clear(&thread->clients[i].history);
        render_clear_configuration(thread, &thread->clients[i]);
    }
    if (thread->watch)
        file_watch_set_files(thread->watch, scene->source_files, scene->source_file_count);
    pthread_mutex_lock(&thread->status_mutex);
    thread->status.ready = true;
    thread->status.revision = thread->revision;
    snprintf(thread->status.scene, sizeof(thread->status.scene), "%s", thread->scene_label);
    pthread_mutex_unlock(&thread->status_mutex);
    send_loaded(thread, other_source);
    render_mark_moving(thread, NULL);
    log_warnings(thread);
    log_write(LOG_INFO, "scene_shown source=\"%s\" nodes=%u triangles=%llu warnings=%u",
              thread->scene_label, scene->node_count,
              (unsigned long long)scene_triangle_count(scene), scene->warning_count);
    return true;
}

static void report_failed_load(struct render_thread *thread, const struct error *error)
{
    log_write(LOG_ERROR, "scene_failed source=\"%s\" reason=\"%s\"", thread->load_label,
              error->message);
    if (!thread->scene && thread->load_client_id == 0) {
        pthread_mutex_lock(&thread->status_mutex);
        thread->status.failed = true;
        pthread_mutex_unlock(&thread->status_mutex);
        thread->params.failed(thread->params.user);
    } else if (thread->load_client_id == 0) {
        char message[ERROR_MESSAGE_SIZE + 32];
        snprintf(message, sizeof(message), "scene not reloaded: %s", error->message);
        render_notice(thread, OUTBOX_TO_ALL, "error", message);
    } else {
        struct command command = {.method = METHOD_SCENE_LOAD,
                                  .client_id = thread->load_client_id,
                                  .id = thread->load_id};
        struct rpc_error reply;
        rpc_error_set(&reply, RPC_LOAD_FAILED, "%s", error->message);
        render_reply_error(thread, &command, &reply);
    }
}

// An image that a reload can no longer read is assumed to be broken or half-written: the last good
// scene stays until the image is complete again.
static bool lost_a_picture(const struct render_thread *thread, const struct scene *scene,
                           struct error *error)
{
    bool reload = thread->scene && thread->load_client_id == 0;
    if (!reload || scene->missing_image_count <= thread->scene->missing_image_count)
        return false;
    const char *text = "an image can no longer be read";
    for (uint32_t i = 0; i < scene->warning_count; i++)
        if (strstr(scene->warnings[i], "left out"))
            text = scene->warnings[i];
    error_set(error, "%.300s", text);
    return true;
}

static void finish_load(struct render_thread *thread, struct scene *scene, struct error *error)
{
    if (scene && lost_a_picture(thread, scene, error))
        scene_destroy(&scene);
    if (!scene || !swap_scene(thread, scene, error)) {
        report_failed_load(thread, error);
        return;
    }
    if (!thread->load_id.json[0])
        return;
    cJSON *result = cJSON_CreateObject();
    cJSON_AddNumberToObject(result, "epoch", (double)thread->epoch);
    cJSON_AddNumberToObject(result, "revision", (double)thread->revision);
    outbox_post(thread->params.outbox, thread->load_client_id,
                rpc_write_result(&thread->load_id, result));
}

void render_poll_scenes(struct render_thread *thread)
{
    struct scene *scene = NULL;
    struct error error;
    if (scene_loader_take(thread->loader, &scene, &error))
        finish_load(thread, scene, &error);
    if (thread->watch && file_watch_take_changed(thread->watch))
        thread->reload_wanted = true;
    if (thread->reload_wanted && thread->scene && !scene_loader_is_busy(thread->loader)) {
        thread->reload_wanted = false;
        char label[sizeof(thread->scene_label)];
        memcpy(label, thread->scene_label, sizeof(label));
        render_start_load(thread, thread->scene->source_path, label, NULL);
    }
}
