// Binds the table of parameters to the fields of the scene and the settings.
//
// The daemon uses it for edits that come as commands, the offline tool for those that come as text.
// Pure data without a thread of its own: the owner of the scene calls it.
#ifndef VOXCAST_SERVER_DOCUMENT_DOCUMENT_H
#define VOXCAST_SERVER_DOCUMENT_DOCUMENT_H

#include <stdbool.h>
#include <stdint.h>

#include "protocol/parameter_value.h"
#include "renderer/renderer.h"

// One client's view, besides the shared document: the rows of protocol/parameters/view.def.
struct view_options {
#define PARAMETER(record, name, type, ...) PARAMETER_FIELD(type, name)
#include "protocol/parameters/view.def"
#undef PARAMETER
    struct view_camera camera;
};

// The rows of protocol/parameters/animation.def.
struct animation_state {
#define PARAMETER(record, name, type, ...) PARAMETER_FIELD(type, name)
#include "protocol/parameters/animation.def"
#undef PARAMETER
};

// Where values are read and written; not owned. A group whose pointer is NULL cannot be addressed.
struct document {
    struct scene *scene; // of light, material, node, environment
    struct render_settings *settings;
    struct animation_state *animations; // one for each animation of the scene
    struct view_options *view;          // of view, camera
};

// Defaults of the table.
void view_options_init(struct view_options *view);
void animation_state_init(struct animation_state *state);

// How many ids a group has now; 1 for groups that are not lists.
uint32_t document_count(const struct document *document, enum parameter_group group);

// Whether `id` exists; else out_error names the field `id` and its range.
bool document_has(const struct document *document, enum parameter_group group, uint32_t id,
                  struct rpc_error *out_error);

// The current value. `id` must exist; it is 0 for groups that are not lists.
void document_get(const struct document *document, const struct parameter *parameter, uint32_t id,
                  struct parameter_value *out_value);

// Sets all values, which must be of one group, or none of them. Refuses with out_error what the
// document in its present state does not allow (such as an equirect environment without an image).
// Normalizes vectors that only give a direction, in `values` too.
bool document_set(const struct document *document, enum parameter_group group, uint32_t id,
                  struct parameter_value *values, uint32_t value_count,
                  struct rpc_error *out_error);

#endif
