#include "server/render/accuracy_service.h"

#include <errno.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

#include <cjson/cJSON.h>

#include "protocol/rpc.h"
#include "server/render/accuracy_session.h"

// The defaults of voxcast accuracy.
#define MEASURED_FRAMES 12
#define MEASURED_EDITS  1
// Below the others, but high enough that locks in the driver are not held for long.
#define NICE 10
// How long a renderer without work is kept, for its compiled shaders.
#define KEPT_SECONDS 60

#define URL_PREFIX "/accuracy/"

struct accuracy_service {
    struct accuracy_service_params params;
    pthread_t thread;
    bool started;
    struct renderer *renderer; // the thread's; NULL while there is no work

    pthread_mutex_t mutex;
    pthread_cond_t changed; // anything below, or a session's `cancelled`
    bool stop, idle;
    struct accuracy_session *sessions; // one per client, and abandoned ones; oldest first
    struct accuracy_session *running;
};

struct accuracy_service *accuracy_service_create(const struct accuracy_service_params *params)
{
    struct accuracy_service *service = calloc(1, sizeof(*service));
    if (!service)
        return NULL;
    service->params = *params;
    pthread_condattr_t attributes;
    pthread_condattr_init(&attributes);
    pthread_condattr_setclock(&attributes, CLOCK_MONOTONIC);
    pthread_mutex_init(&service->mutex, NULL);
    pthread_cond_init(&service->changed, &attributes);
    pthread_condattr_destroy(&attributes);
    return service;
}

static void post(struct accuracy_service *service, const struct accuracy_session *session,
                 enum accuracy_state state, const struct accuracy_progress *progress,
                 const char *message)
{
    cJSON *params = accuracy_session_progress(session, state, progress, message);
    outbox_post(service->params.outbox, session->client_id,
                rpc_write_notification("accuracy.progress", params));
}

// The client's session, unless it has been replaced. The mutex must be held.
static struct accuracy_session *find(const struct accuracy_service *service, uint32_t client_id)
{
    struct accuracy_session *session = service->sessions;
    while (session && (session->client_id != client_id || session->abandoned))
        session = session->next;
    return session;
}

// The mutex must be held.
static void unlink_session(struct accuracy_service *service, const struct accuracy_session *session)
{
    struct accuracy_session **at = &service->sessions;
    while (*at != session)
        at = &(*at)->next;
    *at = session->next;
}

// Ends the client's session for good. Returns it to the caller, who destroys it without the mutex;
// or NULL if there was none, or if the thread will destroy it. The mutex must be held.
static struct accuracy_session *abandon(struct accuracy_service *service, uint32_t client_id)
{
    struct accuracy_session *session = find(service, client_id);
    if (!session)
        return NULL;
    session->abandoned = true;
    atomic_store(&session->cancelled, true);
    pthread_cond_broadcast(&service->changed);
    if (session == service->running)
        return NULL;
    unlink_session(service, session);
    return session;
}

static bool goes_on(const struct accuracy_service *service)
{
    return !service->stop && !atomic_load(&service->running->cancelled);
}

// Waits until no client waits for a frame.
static bool admit_frame(void *user)
{
    struct accuracy_service *service = user;
    pthread_mutex_lock(&service->mutex);
    while (!service->idle && goes_on(service))
        pthread_cond_wait(&service->changed, &service->mutex);
    bool may = goes_on(service);
    pthread_mutex_unlock(&service->mutex);
    return may;
}

// The same within a frame. A frame that has begun is drawn to its end.
static void yield(void *user)
{
    struct accuracy_service *service = user;
    pthread_mutex_lock(&service->mutex);
    while (!service->idle && !service->stop)
        pthread_cond_wait(&service->changed, &service->mutex);
    pthread_mutex_unlock(&service->mutex);
}

static bool tell(void *user, const struct accuracy_progress *progress)
{
    struct accuracy_service *service = user;
    pthread_mutex_lock(&service->mutex);
    struct accuracy_session *session = service->running;
    if (progress->stage == ACCURACY_MEASURING) {
        session->has_reference = true;
        session->configurations_done = progress->done;
        session->state = ACCURACY_CONFIGURATIONS;
    } else {
        session->samples = progress->samples;
        session->noise = progress->noise;
    }
    bool may_go_on = goes_on(service);
    enum accuracy_state state = session->state;
    pthread_mutex_unlock(&service->mutex);
    if (may_go_on)
        post(service, session, state, progress, NULL);
    return may_go_on;
}

static bool open_renderer(struct accuracy_service *service, struct accuracy_session *session,
                          struct error *out_error)
{
    if (service->renderer && renderer_is_lost(service->renderer))
        renderer_destroy(&service->renderer);
    if (!service->renderer)
        service->renderer = renderer_create(&(struct renderer_params){.gpu = service->params.gpu,
                                                                      .admit_frame = admit_frame,
                                                                      .yield = yield,
                                                                      .user = service},
                                            out_error);
    return service->renderer && renderer_set_scene(service->renderer, session->scene, out_error);
}

// Runs without the mutex.
static bool measure(struct accuracy_service *service, struct accuracy_session *session,
                    struct error *out_error)
{
    if (!open_renderer(service, session, out_error))
        return false;
    struct accuracy accuracy = {
        .shot = {.scene = session->scene, .renderer = service->renderer, .params = session->params},
        .folder = session->folder,
        .frames = MEASURED_FRAMES,
        .edits = MEASURED_EDITS};
    struct accuracy_watch watch = {.tell = tell, .user = service};
    cJSON *identity = accuracy_identity(session->source, NULL, 0, &accuracy.shot);
    cJSON_AddNumberToObject(identity, "revision", (double)session->revision);
    struct reference_image_params reference_image = {.shot = &accuracy.shot,
                                                     .until_noise = session->until_noise,
                                                     .max_s = session->max_s,
                                                     .identity = identity,
                                                     .low_priority = true,
                                                     .watch = watch};
    cJSON *results = accuracy_run(&(struct accuracy_run){.accuracy = &accuracy,
                                                         .reference_image = &reference_image,
                                                         .sweep = &session->sweep,
                                                         .watch = watch},
                                  out_error);
    bool done = results != NULL;
    cJSON_Delete(results);
    cJSON_Delete(identity);
    struct error ignored;
    renderer_set_scene(service->renderer, NULL, &ignored);
    return done;
}

// Runs without the mutex. Nothing else uses the session's scene afterwards.
static void run_session(struct accuracy_service *service, struct accuracy_session *session)
{
    struct error error = {""};
    log_write(LOG_INFO,
              "accuracy_started client=%u measurement=%s width=%u height=%u configurations=%u",
              session->client_id, session->id, session->params.width, session->params.height,
              session->sweep.configuration_count);
    post(service, session, ACCURACY_REFERENCE, NULL, NULL);
    bool done = measure(service, session, &error);
    pthread_mutex_lock(&service->mutex);
    bool stopped = !goes_on(service);
    session->state = done ? ACCURACY_DONE : stopped ? ACCURACY_CANCELLED : ACCURACY_FAILED;
    bool abandoned = session->abandoned;
    pthread_mutex_unlock(&service->mutex);
    scene_destroy(&session->scene);
    if (session->state == ACCURACY_FAILED)
        log_write(LOG_ERROR, "accuracy_failed client=%u reason=\"%s\"", session->client_id,
                  error.message);
    if (!abandoned)
        post(service, session, session->state, NULL,
             session->state == ACCURACY_FAILED ? error.message : NULL);
}

// The oldest session that waits. The mutex must be held.
static struct accuracy_session *next_session(const struct accuracy_service *service)
{
    struct accuracy_session *session = service->sessions;
    while (session && session->state != ACCURACY_QUEUED)
        session = session->next;
    return session;
}

// Sleeps until there is work; frees a renderer that has been idle. The mutex must be held.
static void wait_for_work(struct accuracy_service *service)
{
    struct timespec end;
    clock_gettime(CLOCK_MONOTONIC, &end);
    end.tv_sec += KEPT_SECONDS;
    int status = 0;
    while (!service->stop && !next_session(service) && status != ETIMEDOUT)
        status = service->renderer
                     ? pthread_cond_timedwait(&service->changed, &service->mutex, &end)
                     : pthread_cond_wait(&service->changed, &service->mutex);
    if (status == ETIMEDOUT) {
        pthread_mutex_unlock(&service->mutex);
        renderer_destroy(&service->renderer);
        pthread_mutex_lock(&service->mutex);
    }
}

static void *run(void *user)
{
    struct accuracy_service *service = user;
    setpriority(PRIO_PROCESS, (id_t)gettid(), NICE);
    pthread_mutex_lock(&service->mutex);
    while (!service->stop) {
        struct accuracy_session *session = next_session(service);
        if (!session) {
            wait_for_work(service);
            continue;
        }
        session->state = ACCURACY_REFERENCE;
        service->running = session;
        pthread_mutex_unlock(&service->mutex);
        run_session(service, session);
        pthread_mutex_lock(&service->mutex);
        service->running = NULL;
        if (session->abandoned) {
            unlink_session(service, session);
            pthread_mutex_unlock(&service->mutex);
            accuracy_session_destroy(&session);
            pthread_mutex_lock(&service->mutex);
        }
    }
    pthread_mutex_unlock(&service->mutex);
    if (service->renderer)
        renderer_destroy(&service->renderer);
    return NULL;
}

void accuracy_service_stop(struct accuracy_service *service)
{
    pthread_mutex_lock(&service->mutex);
    service->stop = true;
    pthread_cond_broadcast(&service->changed);
    for (struct accuracy_session *session = service->sessions; session; session = session->next)
        accuracy_session_remove_files(session);
    pthread_mutex_unlock(&service->mutex);
}

void accuracy_service_destroy(struct accuracy_service **service_slot)
{
    struct accuracy_service *service = *service_slot;
    *service_slot = NULL;
    if (!service)
        return;
    accuracy_service_stop(service);
    if (service->started)
        pthread_join(service->thread, NULL);
    while (service->sessions) {
        struct accuracy_session *session = service->sessions;
        service->sessions = session->next;
        accuracy_session_destroy(&session);
    }
    pthread_mutex_destroy(&service->mutex);
    pthread_cond_destroy(&service->changed);
    free(service);
}

bool accuracy_service_prepare(struct accuracy_service *service,
                              const struct accuracy_request *request,
                              struct accuracy_ticket *out_ticket, struct error *out_error)
{
    struct accuracy_session *session = accuracy_session_create(request, out_error);
    if (!session)
        return false;
    if (!service->started && pthread_create(&service->thread, NULL, run, service) != 0) {
        accuracy_session_destroy(&session);
        return error_set(out_error, "no thread for measuring can be started");
    }
    service->started = true;
    *out_ticket =
        (struct accuracy_ticket){.configuration_count = session->sweep.configuration_count,
                                 .width = session->params.width,
                                 .height = session->params.height};
    memcpy(out_ticket->id, session->id, sizeof(out_ticket->id));
    pthread_mutex_lock(&service->mutex);
    if (service->stop) {
        pthread_mutex_unlock(&service->mutex);
        accuracy_session_destroy(&session);
        return error_set(out_error, "the server goes away");
    }
    struct accuracy_session *former = abandon(service, request->client_id);
    struct accuracy_session **end = &service->sessions;
    while (*end)
        end = &(*end)->next;
    *end = session;
    pthread_mutex_unlock(&service->mutex);
    accuracy_session_destroy(&former);
    return true;
}

void accuracy_service_submit(struct accuracy_service *service, uint32_t client_id)
{
    pthread_mutex_lock(&service->mutex);
    struct accuracy_session *session = find(service, client_id);
    pthread_mutex_unlock(&service->mutex);
    // Until it is queued, the session belongs to this thread alone, so the client hears of the
    // queue first.
    if (!session || session->state != ACCURACY_PREPARED)
        return;
    post(service, session, ACCURACY_QUEUED, NULL, NULL);
    pthread_mutex_lock(&service->mutex);
    session->state = ACCURACY_QUEUED;
    pthread_cond_broadcast(&service->changed);
    pthread_mutex_unlock(&service->mutex);
}

void accuracy_service_cancel(struct accuracy_service *service, uint32_t client_id)
{
    pthread_mutex_lock(&service->mutex);
    struct accuracy_session *session = find(service, client_id);
    bool waits = session && session->state <= ACCURACY_QUEUED;
    if (session)
        atomic_store(&session->cancelled, true);
    if (waits)
        session->state = ACCURACY_CANCELLED;
    pthread_cond_broadcast(&service->changed);
    pthread_mutex_unlock(&service->mutex);
    // The thread reports the end of a session that runs.
    if (waits) {
        post(service, session, ACCURACY_CANCELLED, NULL, NULL);
        scene_destroy(&session->scene);
    }
}

void accuracy_service_forget(struct accuracy_service *service, uint32_t client_id)
{
    pthread_mutex_lock(&service->mutex);
    struct accuracy_session *session = abandon(service, client_id);
    pthread_mutex_unlock(&service->mutex);
    accuracy_session_destroy(&session);
}

void accuracy_service_set_idle(struct accuracy_service *service, bool idle)
{
    pthread_mutex_lock(&service->mutex);
    service->idle = idle;
    if (idle && service->running)
        pthread_cond_broadcast(&service->changed);
    pthread_mutex_unlock(&service->mutex);
}

static void list_configurations(const struct sweep *sweep, char *out, size_t size)
{
    out[0] = '\0';
    for (size_t i = 0, used = 0; i < sweep->configuration_count && used < size; i++)
        used += (size_t)snprintf(out + used, size - used, "%s%s", i ? ", " : "",
                                 sweep->configurations[i].name);
}

bool accuracy_service_get_configuration(struct accuracy_service *service, uint32_t client_id,
                                        const char *name, struct frame_params *out_params,
                                        double *out_scale, struct error *out_error)
{
    // Sweep and params never change, and sessions end on this thread or after being abandoned.
    pthread_mutex_lock(&service->mutex);
    const struct accuracy_session *session = find(service, client_id);
    pthread_mutex_unlock(&service->mutex);
    if (!session)
        return error_set(out_error,
                         "there is no configuration \"%.60s\": nothing has been measured", name);
    char list[384];
    for (uint32_t i = 0; i < session->sweep.configuration_count; i++) {
        const struct configuration *configuration = &session->sweep.configurations[i];
        if (strcmp(configuration->name, name) != 0)
            continue;
        struct frame_params params = session->params;
        if (!configuration_apply(configuration, &params, out_error))
            return false;
        *out_params = params;
        *out_scale = configuration->scale;
        return true;
    }
    list_configurations(&session->sweep, list, sizeof(list));
    return error_set(out_error, "there is no configuration \"%.60s\"; measured are %s", name, list);
}

bool accuracy_service_find_file(struct accuracy_service *service, const char *url, char *out_path,
                                size_t size)
{
    size_t prefix = sizeof(URL_PREFIX) - 1, id_length = ACCURACY_ID_SIZE - 1;
    if (strncmp(url, URL_PREFIX, prefix) != 0 || strlen(url) < prefix + id_length + 1 ||
        url[prefix + id_length] != '/')
        return false;
    const char *id = url + prefix, *name = id + id_length + 1;
    bool found = false;
    pthread_mutex_lock(&service->mutex);
    for (struct accuracy_session *it = service->sessions; it && !found; it = it->next)
        found = !it->abandoned && memcmp(it->id, id, id_length) == 0 &&
                accuracy_session_has_file(it, name) &&
                snprintf(out_path, size, "%s/%s", it->folder, name) < (int)size;
    pthread_mutex_unlock(&service->mutex);
    return found;
}
