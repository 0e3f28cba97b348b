// Statistics of the frames of one view, and their JSON.
#ifndef VOXCAST_SERVER_ACCURACY_MEASUREMENT_H
#define VOXCAST_SERVER_ACCURACY_MEASUREMENT_H

#include "renderer/renderer.h"
#include "server/accuracy/samples.h"

// What was measured over the frames of one view.
struct measurement {
    struct samples frame_ms;
    struct samples pass_ms[RENDERER_MAX_PASSES];
};

// Adds the newest collected frame.
bool measurement_add(struct measurement *measurement, const struct frame_statistics *statistics);
void measurement_finish(struct measurement *measurement);

// {"gl_renderer", "size", "frame_ms", "passes", "effects", "memory_bytes", "scene"} as the README
// describes: a cJSON object that the caller deletes. NULL when memory ends.
struct cJSON;
struct cJSON *measurement_json(const struct measurement *measurement,
                               const struct frame_statistics *statistics,
                               const struct renderer_info *info, const struct scene *scene,
                               uint32_t width, uint32_t height);

#endif
