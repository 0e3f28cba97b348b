// Binds the table of parameters to the fields of the scene and the settings.
//
// Used by the daemon, where edits come as commands, and by the offline tool, where they come as
// text. Pure data; no thread of its own: whoever owns the scene calls.
#ifndef VOXCAST_SERVER_DOCUMENT_DOCUMENT_H
#define VOXCAST_SERVER_DOCUMENT_DOCUMENT_H

#include <stdbool.h>
#include <stdint.h>

#include "protocol/parameter_value.h"
#include "renderer/renderer.h"

// What one client's view is beside the shared document; the rows of protocol/parameters/view.def.
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

// The places that values go to; not owned. A group whose place is NULL cannot be addressed.
struct document {
    struct scene *scene; // light, material, node, environment
    struct render_settings *settings;
    struct animation_state *animations; // one for each animation of the scene
    struct view_options *view;          // view, camera
};

// Defaults of the table.
void view_options_init(struct view_options *view);
void animation_state_init(struct animation_state *state);

// How many ids a group has now; 1 for the groups that are not lists.
uint32_t document_count(const struct document *document, enum parameter_group group);

// Whether `id` names something that is there; else out_error names the field `id` and its range.
bool document_has(const struct document *document, enum parameter_group group, uint32_t id,
                  struct rpc_error *out_error);

// The value in use. `id` must be there; it is 0 for groups that are not lists.
void document_get(const struct document *document, const struct parameter *parameter, uint32_t id,
                  struct parameter_value *out_value);

// Sets all values, which are of one group, or none: refuses with out_error what the document as it
// stands does not allow (such as an equirect environment without an image). Vectors that only
// give a direction are made unit length, in `values` too.
bool document_set(const struct document *document, enum parameter_group group, uint32_t id,
                  struct parameter_value *values, uint32_t value_count,
                  struct rpc_error *out_error);

#endif
