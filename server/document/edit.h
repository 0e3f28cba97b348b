// Applies edits to the document, reports them to the other clients, and undoes them.
//
// Runs on the render thread, which owns the document.
#ifndef VOXCAST_SERVER_DOCUMENT_EDIT_H
#define VOXCAST_SERVER_DOCUMENT_EDIT_H

#include <cjson/cJSON.h>

#include "protocol/command.h"
#include "server/document/document.h"

#define EDIT_HISTORY_STEPS 64u
// Bound on the environment images that one client's undo steps keep. Beyond it the oldest steps go;
// the newest one stays.
#define EDIT_HISTORY_IMAGE_BYTES (512ull << 20)

// One undo step: what an edit changed.
struct edit_step {
    enum method method;
    uint32_t target;
    bool open; // the newest edit in it was transient: the next one of the same fields joins it
    uint32_t value_count;
    struct parameter_value before[COMMAND_MAX_VALUES];
    struct parameter_value after[COMMAND_MAX_VALUES];
    struct environment_image *image_before, *image_after; // of environment.load; referenced
};

// One client's edits: steps below `position` can be undone, the others redone. All zero is empty.
struct edit_history {
    uint32_t count;
    uint32_t position;
    struct edit_step *steps[EDIT_HISTORY_STEPS]; // owned
};

void edit_history_clear(struct edit_history *history);

// Applies a command with METHOD_EDITS other than scene.load and environment.load. On success
// `out_edit` is the member of `edits` that PROTOCOL.md describes, without the revision; the caller
// owns it. It is NULL if there was nothing to undo or redo. Further members of the reply are added
// to `result`.
bool edit_apply(const struct document *document, struct edit_history *history,
                struct command *command, cJSON *result, cJSON **out_edit,
                struct rpc_error *out_error);

// Sets an image as the environment and keeps references of its own. Returns the edit as above. The
// history may be NULL: then nobody can undo it.
cJSON *edit_load_environment(const struct document *document, struct edit_history *history,
                             struct environment_image *image);

#endif
