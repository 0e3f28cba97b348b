// The document as JSON, as PROTOCOL.md defines it. Runs on the render thread, which owns the
// document. The caller owns each result.
#ifndef VOXCAST_SERVER_DOCUMENT_DOCUMENT_JSON_H
#define VOXCAST_SERVER_DOCUMENT_DOCUMENT_JSON_H

#include <cjson/cJSON.h>

#include "server/document/document.h"

// Adds every parameter of a group to `object`, with its present value.
void document_json_add_group(cJSON *object, const struct document *document,
                             enum parameter_group group, uint32_t id);

cJSON *document_json_group(const struct document *document, enum parameter_group group,
                           uint32_t id);
cJSON *document_json_light(const struct document *document, uint32_t id);
cJSON *document_json_node(const struct document *document, uint32_t id);

// A fresh object of parameter names and values: `set` of an edit.
cJSON *document_json_values(const struct parameter_value *values, uint32_t value_count);

// The result of scene.get without epoch and revision.
cJSON *document_json_scene(const struct document *document);

// {"image", "width", "height", "thumbnail"}; NULL when out of memory.
cJSON *document_json_texture(const struct scene *scene, uint32_t image_id);

#endif
