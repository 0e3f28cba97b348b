// The newest edits, so that a client that reconnects can catch up.
#ifndef VOXCAST_SERVER_DOCUMENT_EDIT_LOG_H
#define VOXCAST_SERVER_DOCUMENT_EDIT_LOG_H

#include <cjson/cJSON.h>
#include <stdint.h>

#define EDIT_LOG_ENTRIES 1024u

// The newest edits, so that a client can catch up. All zero is empty.
struct edit_log {
    uint32_t count;
    uint32_t first;
    struct {
        uint64_t revision;
        cJSON *edit; // owned
    } entries[EDIT_LOG_ENTRIES];
};

// Takes over `edit`. Revisions count up by 1.
void edit_log_add(struct edit_log *log, uint64_t revision, cJSON *edit);
void edit_log_clear(struct edit_log *log);

// The edits after `since` up to `newest`, owned by the caller; NULL if the log does not reach back
// that far.
cJSON *edit_log_since(const struct edit_log *log, uint64_t since, uint64_t newest);

#endif
