// The methods of the protocol: parameters are checked and turned into plain data. Pure.
#ifndef VOXCAST_PROTOCOL_COMMAND_H
#define VOXCAST_PROTOCOL_COMMAND_H

#include <stdbool.h>
#include <stdint.h>

#include "protocol/limits.h"
#include "protocol/parameter_value.h"
#include "protocol/parameters.h"
#include "protocol/rpc.h"

#define METHOD(constant, ...) METHOD_##constant,
enum method {
#include "protocol/methods.def"
    METHOD_COUNT
};
#undef METHOD

enum method_flags {
    METHOD_EDITS = 1,  // changes the shared document: not for viewers
    METHOD_MERGES = 2, // a newer one of the same client, target and fields replaces a waiting one
};

// Which configurations accuracy.start measures.
enum command_sweep { SWEEP_QUICK, SWEEP_FULL, SWEEP_COUNT };

extern const char *const command_sweep_names[SWEEP_COUNT + 1]; // ended by NULL

#define COMMAND_DEFAULT_NOISE   0.01
#define COMMAND_DEFAULT_SECONDS 120.0
#define COMMAND_MAX_VALUES      24u
#define COMMAND_MAX_SUPERSEDED  32u
#define COMMAND_NO_TARGET       UINT32_MAX

struct command {
    enum method method;
    struct rpc_id id;
    uint32_t client_id; // filled by the server
    bool viewer;        // likewise: may not edit
    uint32_t target;    // `id` or `image`
    bool has_edit_id;
    uint64_t edit_id;
    bool transient;
    bool has_revision;
    uint64_t revision; // of camera.set; frame_id of frame.ack
    bool has_resume;   // both of the following came
    uint64_t resume_epoch, resume_revision;
    double x, y;              // of pick
    enum command_sweep sweep; // of accuracy.start
    double noise, seconds;    // likewise
    char name[PROTOCOL_MAX_NAME_BYTES + 1];
    char token[PROTOCOL_MAX_TOKEN_BYTES + 1];
    char source[PROTOCOL_MAX_SOURCE_BYTES + 1]; // also `name` of environment.load
    uint32_t value_count;
    struct parameter_value values[COMMAND_MAX_VALUES];
    uint32_t superseded_count; // edit ids that this command stands for, besides its own
    uint64_t superseded[COMMAND_MAX_SUPERSEDED];
};

const char *method_name(enum method method);
uint32_t method_get_flags(enum method method);

// The group that `set` of this method takes, or GROUP_COUNT.
enum parameter_group method_get_group(enum method method);

// Checks method and params. On failure `out_command` is undefined except its id.
bool command_parse(const struct rpc_request *request, struct command *out_command,
                   struct rpc_error *out_error);

// Whether `newer` makes `older` unnecessary: a method that merges, and the same client, target and
// set of fields.
bool command_supersedes(const struct command *newer, const struct command *older);

#endif
