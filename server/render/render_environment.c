// Loading environment images and reloading them when their file changes.
#include "server/render/render_internal.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void render_run_environment_load(struct render_thread *thread, const struct command *command)
{
    struct error error;
    struct rpc_error reply;
    char *path =
        scene_loader_resolve_environment(thread->params.scene_dir, command->source, &error);
    if (!path) {
        rpc_error_field(&reply, "name", NULL, "name: %s", error.message);
        render_reply_error(thread, command, &reply);
        return;
    }
    struct command *copy = malloc(sizeof(*copy));
    if (copy && environment_loader_start(thread->environment_loader, path)) {
        *copy = *command;
        thread->environment_command = copy;
        thread->environment_epoch = thread->epoch;
    } else {
        free(copy);
        rpc_error_set(&reply, RPC_BUSY, "another environment is being loaded");
        render_reply_error(thread, command, &reply);
    }
    free(path);
}

static void refuse(struct render_thread *thread, const struct command *command, const char *message)
{
    log_write(LOG_ERROR, "environment_failed name=\"%s\" reason=\"%s\"",
              command ? command->source : "", message);
    if (command) {
        struct rpc_error reply;
        rpc_error_set(&reply, RPC_LOAD_FAILED, "%s", message);
        render_reply_error(thread, command, &reply);
    } else {
        char notice[ERROR_MESSAGE_SIZE + 40];
        snprintf(notice, sizeof(notice), "environment not reloaded: %s", message);
        render_notice(thread, OUTBOX_TO_ALL, "error", notice);
    }
}

static void reply_loaded(struct render_thread *thread, const struct command *command,
                         const struct environment_image *image)
{
    cJSON *result = cJSON_CreateObject();
    cJSON_AddNumberToObject(result, "revision", (double)thread->revision);
    if (command->has_edit_id)
        cJSON_AddNumberToObject(result, "edit_id", (double)command->edit_id);
    cJSON_AddItemToObject(result, "superseded", cJSON_CreateArray());
    cJSON_AddNumberToObject(result, "width", image->width);
    cJSON_AddNumberToObject(result, "height", image->height);
    cJSON *warnings = cJSON_AddArrayToObject(result, "warnings");
    if (image->warning[0])
        cJSON_AddItemToArray(warnings, cJSON_CreateString(image->warning));
    render_reply(thread, command, result);
}

// An edit by `client`, or by nobody where a file has changed.
static void show(struct render_thread *thread, struct render_client *client,
                 const struct command *command, struct environment_image *image)
{
    static const struct command reload = {.method = METHOD_ENVIRONMENT_LOAD};
    struct document document = render_document(thread, NULL);
    cJSON *edit = edit_load_environment(&document, client ? &client->history : NULL, image);
    render_publish_edit(thread, client, command ? command : &reload, edit);
    if (image->warning[0])
        log_write(LOG_WARN, "environment_warning name=\"%s\" text=\"%s\"", image->name,
                  image->warning);
    log_write(LOG_INFO, "environment_shown name=\"%s\" width=%u height=%u", image->name,
              image->width, image->height);
    if (command)
        reply_loaded(thread, command, image);
}

// Takes over the image's reference.
static void finish_load(struct render_thread *thread, struct environment_image *image,
                        const struct error *error)
{
    struct command *command = thread->environment_command;
    thread->environment_command = NULL;
    struct render_client *client = command ? render_find_client(thread, command->client_id) : NULL;
    struct environment_image *shown = thread->scene ? thread->scene->environment.image : NULL;
    bool other_scene = thread->environment_epoch != thread->epoch;
    // The file that changed on disk may not be the one that is shown any more.
    bool stale = !command && (other_scene || !shown || !shown->path ||
                              (image && strcmp(shown->path, image->path) != 0));
    bool gone = command && !client; // its undo steps have gone, too
    if (!image && !stale) {
        refuse(thread, command, error->message);
    } else if (command && other_scene) {
        refuse(thread, command, "another scene was loaded meanwhile");
    } else if (image && !stale && !gone) {
        snprintf(image->name, sizeof(image->name), "%s", command ? command->source : shown->name);
        show(thread, client, command, image);
    }
    environment_image_release(&image);
    free(command);
}

static void watch(struct render_thread *thread)
{
    struct environment_image *image = thread->scene ? thread->scene->environment.image : NULL;
    uint64_t serial = image && image->path ? image->serial : 0;
    if (!thread->environment_watch || serial == thread->environment_watched)
        return;
    file_watch_set_files(thread->environment_watch, serial ? &image->path : NULL, serial ? 1 : 0);
    thread->environment_watched = serial;
}

void render_poll_environment(struct render_thread *thread)
{
    struct environment_image *image = NULL;
    struct error error;
    if (environment_loader_take(thread->environment_loader, &image, &error))
        finish_load(thread, image, &error);
    if (thread->environment_watch && file_watch_take_changed(thread->environment_watch))
        thread->environment_reload_wanted = true;
    image = thread->scene ? thread->scene->environment.image : NULL;
    if (thread->environment_reload_wanted &&
        !environment_loader_is_busy(thread->environment_loader)) {
        thread->environment_reload_wanted = false;
        if (image && image->path &&
            environment_loader_start(thread->environment_loader, image->path))
            thread->environment_epoch = thread->epoch;
    }
    watch(thread);
}
