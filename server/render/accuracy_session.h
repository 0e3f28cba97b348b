// One measurement of the daemon: what is measured, its progress, and its files.
#ifndef VOXCAST_SERVER_ACCURACY_ACCURACY_SESSION_H
#define VOXCAST_SERVER_ACCURACY_ACCURACY_SESSION_H

#include <stdatomic.h>

#include "server/accuracy/accuracy.h"
#include "server/render/accuracy_service.h"

enum accuracy_state {
    ACCURACY_PREPARED, // not submitted yet
    ACCURACY_QUEUED,
    ACCURACY_REFERENCE,
    ACCURACY_CONFIGURATIONS,
    ACCURACY_DONE,
    ACCURACY_CANCELLED,
    ACCURACY_FAILED,
};

struct accuracy_session {
    // Constant.
    char id[ACCURACY_ID_SIZE];
    uint32_t client_id;
    char source[256];
    uint64_t revision;
    struct sweep sweep;         // the live configuration comes first
    struct frame_params params; // with the measured size
    double until_noise, max_s;
    char folder[4096];
    struct scene *scene; // owned; belongs to the measuring thread once that has started

    atomic_bool cancelled;
    // Protected by the service's mutex.
    enum accuracy_state state;
    bool abandoned;               // replaced, or its client has gone: nobody may see it any more
    bool has_reference;           // reference.png exists
    uint32_t configurations_done; // how many of the sweep's configurations are in results.json
    struct accuracy_session *next;

    // Used by the measuring thread alone.
    uint32_t samples;
    double noise;
};

// Takes over the request's scene even on failure. NULL with a message.
struct accuracy_session *accuracy_session_create(const struct accuracy_request *request,
                                                 struct error *out_error);

void accuracy_session_remove_files(const struct accuracy_session *session);

// Also removes the files.
void accuracy_session_destroy(struct accuracy_session **session);

// Params of accuracy.progress. `progress` may be NULL; `message` is the reason of a failure.
struct cJSON *accuracy_session_progress(const struct accuracy_session *session,
                                        enum accuracy_state state,
                                        const struct accuracy_progress *progress,
                                        const char *message);

// Whether the session has a file of this name that may be read now. The service's mutex must be
// held.
bool accuracy_session_has_file(const struct accuracy_session *session, const char *name);

#endif
