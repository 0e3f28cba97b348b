#include "server/render/accuracy_session.h"

#include <errno.h>
#include <ftw.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <sys/random.h>

#include <cjson/cJSON.h>

#define MAX_OPEN_FOLDERS 4
#define REMOVE_TRIES     10

static bool choose_id(char out_id[ACCURACY_ID_SIZE])
{
    uint8_t bytes[(ACCURACY_ID_SIZE - 1) / 2];
    if (getrandom(bytes, sizeof(bytes), 0) != (ssize_t)sizeof(bytes))
        return false;
    for (size_t i = 0; i < sizeof(bytes); i++)
        snprintf(out_id + 2 * i, 3, "%02x", bytes[i]);
    return true;
}

// The view's size, scaled down to the limit of measured pixels. (No view is so narrow that an edge
// becomes 0.)
static void choose_size(struct frame_params *params)
{
    double pixels = (double)params->width * params->height;
    if (pixels <= ACCURACY_MAX_PIXELS)
        return;
    double scale = sqrt(ACCURACY_MAX_PIXELS / pixels);
    params->width = (uint32_t)floor(params->width * scale);
    params->height = (uint32_t)floor(params->height * scale);
}

static bool fill_sweep(struct accuracy_session *session, const char *name, struct error *out_error)
{
    struct sweep *sweep = &session->sweep;
    if (!sweep_load(name, sweep, out_error))
        return false;
    memmove(&sweep->configurations[1], &sweep->configurations[0],
            (SWEEP_MAX_CONFIGURATIONS - 1) * sizeof(sweep->configurations[0]));
    sweep->configurations[0] = (struct configuration){
        .name = ACCURACY_LIVE_CONFIGURATION, .quality = session->params.quality, .scale = 1.0};
    sweep->configuration_count += sweep->configuration_count < SWEEP_MAX_CONFIGURATIONS;
    return true;
}

static bool make_folder(struct accuracy_session *session, struct error *out_error)
{
    const char *parent = getenv("TMPDIR");
    char path[sizeof(session->folder)];
    snprintf(path, sizeof(path), "%s/voxcast-accuracy-XXXXXX", parent && *parent ? parent : "/tmp");
    if (!mkdtemp(path))
        return error_set(out_error, "cannot make a folder \"%.300s\": %s", path, strerror(errno));
    memcpy(session->folder, path, sizeof(path));
    return true;
}

struct accuracy_session *accuracy_session_create(const struct accuracy_request *request,
                                                 struct error *out_error)
{
    struct scene *scene = request->scene;
    struct accuracy_session *session = calloc(1, sizeof(*session));
    if (!session) {
        scene_destroy(&scene);
        error_set(out_error, "out of memory");
        return NULL;
    }
    session->client_id = request->client_id;
    session->scene = scene;
    session->revision = request->revision;
    session->params = request->params;
    session->until_noise = request->until_noise;
    session->max_s = request->max_s;
    session->noise = NAN;
    snprintf(session->source, sizeof(session->source), "%s", request->source);
    choose_size(&session->params);
    bool done = choose_id(session->id) || error_set(out_error, "the system gives no random number");
    if (!done || !fill_sweep(session, request->sweep, out_error) ||
        !make_folder(session, out_error))
        accuracy_session_destroy(&session);
    return session;
}

static int remove_entry(const char *path, const struct stat *status, int kind, struct FTW *walk)
{
    (void)status;
    (void)kind;
    (void)walk;
    // A file that is being written may be renamed meanwhile.
    return remove(path) == 0 || errno == ENOENT ? 0 : -1;
}

void accuracy_session_remove_files(const struct accuracy_session *session)
{
    // New files may appear while others are removed, but none once the folder has gone.
    for (int i = 0; session->folder[0] && i < REMOVE_TRIES; i++) {
        nftw(session->folder, remove_entry, MAX_OPEN_FOLDERS, FTW_DEPTH | FTW_PHYS);
        if (access(session->folder, F_OK) != 0)
            return;
    }
    if (session->folder[0])
        log_write(LOG_WARN, "accuracy_files_left folder=\"%s\"", session->folder);
}

void accuracy_session_destroy(struct accuracy_session **session_slot)
{
    struct accuracy_session *session = *session_slot;
    *session_slot = NULL;
    if (!session)
        return;
    accuracy_session_remove_files(session);
    scene_destroy(&session->scene);
    free(session);
}

cJSON *accuracy_session_progress(const struct accuracy_session *session, enum accuracy_state state,
                                 const struct accuracy_progress *progress, const char *message)
{
    static const char *const names[] = {
        [ACCURACY_PREPARED] = "queued",     [ACCURACY_QUEUED] = "queued",
        [ACCURACY_REFERENCE] = "reference", [ACCURACY_CONFIGURATIONS] = "rungs",
        [ACCURACY_DONE] = "done",           [ACCURACY_CANCELLED] = "cancelled",
        [ACCURACY_FAILED] = "failed"};
    cJSON *json = cJSON_CreateObject();
    cJSON_AddStringToObject(json, "measurement", session->id);
    cJSON_AddStringToObject(json, "state", names[state]);
    if (message)
        cJSON_AddStringToObject(json, "message", message);
    cJSON_AddNumberToObject(json, "samples", session->samples);
    cJSON_AddNumberToObject(json, "noise", session->noise); // null unless finite
    cJSON_AddNumberToObject(json, "noise_wanted", session->until_noise);
    cJSON_AddNumberToObject(json, "done", session->configurations_done);
    cJSON_AddNumberToObject(json, "rung_count", session->sweep.configuration_count);
    cJSON_AddItemToObject(json, "rung",
                          progress && progress->next ? cJSON_CreateString(progress->next->name)
                                                     : cJSON_CreateNull());
    cJSON_AddNumberToObject(json, "seconds_left", progress ? progress->left_s : NAN);
    return json;
}

bool accuracy_session_has_file(const struct accuracy_session *session, const char *name)
{
    static const char *const suffixes[] = {"converged", "error", "strip"};
    char file[CONFIGURATION_NAME_SIZE + 32];
    if (strcmp(name, "results.json") == 0)
        return session->configurations_done > 0;
    if (strcmp(name, "reference.png") == 0)
        return session->has_reference;
    for (uint32_t i = 0; i < session->configurations_done; i++)
        for (size_t k = 0; k < sizeof(suffixes) / sizeof(suffixes[0]); k++) {
            snprintf(file, sizeof(file), "%s-%s.png", session->sweep.configurations[i].name,
                     suffixes[k]);
            if (strcmp(name, file) == 0)
                return true;
        }
    return false;
}
