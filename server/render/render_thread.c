#include "server/render/render_thread.h"

#include <glob.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "renderer/clock.h"
#include "server/document/edit_log.h"
#include "server/render/render_internal.h"

#define ANIMATION_STEP_US 15000u

struct document render_document(struct render_thread *thread, struct render_client *client)
{
    return (struct document){
        .scene = thread->scene,
        .settings = &thread->settings,
        .animations = thread->animations,
        .view = client ? &client->options : NULL,
    };
}

void render_reply(struct render_thread *thread, const struct command *command, cJSON *result)
{
    if (command->id.json[0])
        outbox_post(thread->params.outbox, command->client_id,
                    rpc_write_result(&command->id, result));
    else
        cJSON_Delete(result);
}

void render_reply_error(struct render_thread *thread, const struct command *command,
                        const struct rpc_error *error)
{
    if (command->id.json[0]) {
        outbox_post(thread->params.outbox, command->client_id,
                    rpc_write_error(&command->id, error));
        return;
    }
    cJSON *notice = cJSON_CreateObject();
    cJSON_AddStringToObject(notice, "level", "error");
    cJSON_AddStringToObject(notice, "message", error->message);
    cJSON_AddStringToObject(notice, "method", method_name(command->method));
    if (command->has_edit_id)
        cJSON_AddNumberToObject(notice, "edit_id", (double)command->edit_id);
    outbox_post(thread->params.outbox, command->client_id,
                rpc_write_notification("session.notice", notice));
}

void render_notice(struct render_thread *thread, uint32_t client_id, const char *level,
                   const char *message)
{
    cJSON *notice = cJSON_CreateObject();
    cJSON_AddStringToObject(notice, "level", level);
    cJSON_AddStringToObject(notice, "message", message);
    outbox_post(thread->params.outbox, client_id, rpc_write_notification("session.notice", notice));
}

cJSON *render_author(const struct render_client *client)
{
    if (!client)
        return cJSON_CreateNull();
    cJSON *author = cJSON_CreateObject();
    cJSON_AddNumberToObject(author, "client_id", client->client_id);
    cJSON_AddStringToObject(author, "name", client->name);
    return author;
}

static void wake(void *user)
{
    struct render_thread *thread = user;
    mailbox_wake(thread->params.mailbox);
}

// Whether a frame could be sent to any client if its image changed.
static bool any_could_draw(struct render_thread *thread)
{
    for (uint32_t slot = 0; slot < FRAME_STREAM_MAX_CLIENTS; slot++) {
        const struct render_client *client = &thread->clients[slot];
        if (client->client_id && !client->options.paused && !client->drawing &&
            frame_stream_wants_frame(thread->params.stream, slot))
            return true;
    }
    return false;
}

// Advances running animations to the present. Returns when to call again.
static uint64_t animate(struct render_thread *thread)
{
    struct scene *scene = thread->scene;
    uint64_t now = clock_now_us();
    double passed_s = (double)(now - thread->animated_at_us) / 1e6;
    bool playing = false;
    for (uint32_t i = 0; scene && i < scene->animation_count; i++)
        playing = playing || thread->animations[i].playing;
    if (!playing) {
        thread->animated_at_us = now;
        return MAILBOX_NO_DEADLINE;
    }
    // While nobody can see it, time is caught up with later.
    if (!any_could_draw(thread))
        return MAILBOX_NO_DEADLINE;
    if (now - thread->animated_at_us < ANIMATION_STEP_US)
        return thread->animated_at_us + ANIMATION_STEP_US;
    for (uint32_t i = 0; i < scene->animation_count; i++) {
        struct animation_state *state = &thread->animations[i];
        float duration = scene->animations[i].duration_s;
        if (!state->playing)
            continue;
        double time = state->time_s + passed_s * state->speed;
        if (state->loop && duration > 0.0f) {
            time = fmod(time, duration);
            time += time < 0.0 ? duration : 0.0;
        }
        state->time_s = fminf(fmaxf((float)time, 0.0f), duration);
        scene_animate(scene, i, state->time_s);
    }
    thread->animated_at_us = now;
    render_mark_moving(thread, NULL);
    return now + ANIMATION_STEP_US;
}

static void poll_shaders(struct render_thread *thread)
{
    struct error error = {""};
    if (renderer_poll_shaders(thread->renderer, &error) > 0)
        render_mark_dirty(thread, NULL);
    if (error.message[0])
        render_notice(thread, OUTBOX_TO_ALL, "error", error.message);
}

static void turn(struct render_thread *thread)
{
    render_remove_gone_clients(thread, false);
    struct command *command;
    while ((command = mailbox_take(thread->params.mailbox))) {
        render_run_command(thread, command);
        free(command);
    }
    render_poll_scenes(thread);
    render_poll_environment(thread);
    poll_shaders(thread);
    uint64_t deadline_us = animate(thread);
    uint64_t idle_us = render_idle_from_us(thread);
    bool idle = idle_us <= clock_now_us();
    accuracy_service_set_idle(thread->params.accuracy, idle);
    bool drew = render_draw_next(thread);
    bool collected = render_collect(thread, !drew);
    if (drew || collected)
        return;
    uint64_t draw_us = render_next_draw_us(thread);
    deadline_us = draw_us < deadline_us ? draw_us : deadline_us;
    if (!idle && idle_us < deadline_us)
        deadline_us = idle_us;
    mailbox_wait(thread->params.mailbox, deadline_us);
}

static void watch_shaders(struct render_thread *thread)
{
    char *pattern = NULL;
    glob_t files = {0};
    if (!thread->shader_watch ||
        asprintf(&pattern, "%s/*/*", renderer_get_shader_dir(thread->renderer)) < 0)
        return;
    if (glob(pattern, 0, NULL, &files) == 0)
        file_watch_set_files(thread->shader_watch, files.gl_pathv, (uint32_t)files.gl_pathc);
    globfree(&files);
    free(pattern);
}

static bool open_renderer(struct render_thread *thread)
{
    struct error error = {""};
    struct renderer_params params = {.gpu = thread->params.gpu, .watch_shaders = true};
    thread->renderer = renderer_create(&params, &error);
    if (!thread->renderer) {
        log_write(LOG_ERROR, "renderer_failed reason=\"%s\"", error.message);
        pthread_mutex_lock(&thread->status_mutex);
        thread->status.failed = true;
        pthread_mutex_unlock(&thread->status_mutex);
        thread->params.failed(thread->params.user);
        return false;
    }
    const struct renderer_info *info = renderer_get_info(thread->renderer);
    log_write(LOG_INFO, "renderer_ready gl=\"%s\" version=\"%s\" software=%d", info->gl_renderer,
              info->gl_version, info->software);
    pthread_mutex_lock(&thread->status_mutex);
    snprintf(thread->status.gl_renderer, sizeof(thread->status.gl_renderer), "%s",
             info->gl_renderer);
    pthread_mutex_unlock(&thread->status_mutex);
    watch_shaders(thread);
    return true;
}

// For tests: loses the context at that frame.
static void inject_fault(struct render_thread *thread)
{
    const char *frame = getenv("VOXCAST_LOSE_CONTEXT");
    if (frame)
        renderer_inject_fault(thread->renderer, RENDERER_FAULT_CONTEXT, strtoull(frame, NULL, 10));
}

// Creates another renderer in place of one whose GL context is lost. The document and all clients
// stay.
static void renew_renderer(struct render_thread *thread)
{
    struct error error = {""};
    log_write(LOG_ERROR, "context_lost");
    render_drop_views(thread);
    renderer_destroy(&thread->renderer);
    if (!open_renderer(thread)) {
        atomic_store(&thread->stop, true);
        return;
    }
    if ((thread->scene && !renderer_set_scene(thread->renderer, thread->scene, &error)) ||
        !render_renew_views(thread)) {
        log_write(LOG_ERROR, "renderer_failed reason=\"%s\"", error.message);
        atomic_store(&thread->stop, true);
        thread->params.failed(thread->params.user);
    }
}

static void *run(void *user)
{
    struct render_thread *thread = user;
    if (!open_renderer(thread))
        return NULL;
    inject_fault(thread);
    const char *source = thread->params.scene_source;
    const char *slash = strrchr(source, '/');
    render_start_load(thread, source, slash ? slash + 1 : source, NULL);
    while (!atomic_load(&thread->stop)) {
        turn(thread);
        if (thread->renderer && renderer_is_lost(thread->renderer))
            renew_renderer(thread);
    }
    render_remove_gone_clients(thread, true);
    if (thread->renderer)
        renderer_destroy(&thread->renderer);
    scene_destroy(&thread->scene);
    return NULL;
}

struct render_thread *render_thread_start(const struct render_thread_params *params)
{
    struct render_thread *thread = calloc(1, sizeof(*thread));
    if (!thread)
        return NULL;
    thread->params = *params;
    // Clients must not take epochs of an earlier run of the daemon for epochs of this run.
    thread->epoch = (uint64_t)time(NULL);
    render_settings_init(&thread->settings);
    pthread_mutex_init(&thread->status_mutex, NULL);
    thread->loader = scene_loader_create(wake, thread);
    thread->environment_loader = environment_loader_create(wake, thread);
    thread->watch = file_watch_create(wake, thread);
    thread->environment_watch = file_watch_create(wake, thread);
    thread->shader_watch = file_watch_create(wake, thread);
    if (!thread->loader || !thread->environment_loader ||
        pthread_create(&thread->thread, NULL, run, thread) != 0) {
        scene_loader_destroy(&thread->loader);
        environment_loader_destroy(&thread->environment_loader);
        file_watch_destroy(&thread->watch);
        file_watch_destroy(&thread->environment_watch);
        file_watch_destroy(&thread->shader_watch);
        pthread_mutex_destroy(&thread->status_mutex);
        free(thread);
        return NULL;
    }
    return thread;
}

void render_thread_stop(struct render_thread *thread)
{
    atomic_store(&thread->stop, true);
    mailbox_wake(thread->params.mailbox);
}

void render_thread_destroy(struct render_thread **thread)
{
    struct render_thread *t = *thread;
    if (!t)
        return;
    render_thread_stop(t);
    pthread_join(t->thread, NULL);
    scene_loader_destroy(&t->loader);
    environment_loader_destroy(&t->environment_loader);
    free(t->environment_command);
    file_watch_destroy(&t->watch);
    file_watch_destroy(&t->environment_watch);
    file_watch_destroy(&t->shader_watch);
    edit_log_clear(&t->log);
    free(t->animations);
    free(t->load_source);
    pthread_mutex_destroy(&t->status_mutex);
    free(t);
    *thread = NULL;
}

void render_thread_get_status(struct render_thread *thread, struct render_status *out_status)
{
    pthread_mutex_lock(&thread->status_mutex);
    *out_status = thread->status;
    pthread_mutex_unlock(&thread->status_mutex);
}
