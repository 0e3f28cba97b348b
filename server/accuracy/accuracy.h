// voxcast accuracy: error against time for every configuration of a sweep.
#ifndef VOXCAST_SERVER_ACCURACY_ACCURACY_H
#define VOXCAST_SERVER_ACCURACY_ACCURACY_H

#include "renderer/metrics/display.h"
#include "server/accuracy/reference_image.h"
#include "server/accuracy/results.h"

struct cJSON;

// What all configurations of a run share.
struct accuracy {
    struct shot shot; // holds the settings and the camera that configurations start from
    struct reference_image reference_image;
    bool *self_lit; // pixels on or near emission and background: indirect light is not compared
                    // there, since their edges would dominate
    struct display_params display;
    const char *folder;
    uint32_t frames; // of a moving camera, to measure
    uint32_t edits;  // of a light, to measure; 0 for none
};

// Compares an image with the reference image. Adds "metrics" to the object and, where the reference
// image's direct light is known, "indirect": metrics of what remains without `direct`. `flip_map`
// receives the errors of LDR-FLIP.
bool accuracy_judge(const struct accuracy *accuracy, const struct picture *picture,
                    const struct picture *direct, struct cJSON *object, float *flip_map,
                    struct error *out_error);

// Measures one configuration and writes its images into the folder. The caller owns the result, an
// entry of results.json; NULL with a message.
struct cJSON *accuracy_measure(const struct accuracy *accuracy,
                               const struct configuration *configuration, struct error *out_error);

// Describes the view of the shot and the scene: what it was loaded from and, as KEY=VALUE, how it
// was edited.
struct cJSON *accuracy_identity(const char *source, const char *const *sets, uint32_t set_count,
                                const struct shot *shot);

// The program's quality table: for each preset all that its row holds, enums by their names. The
// caller deletes it.
struct cJSON *accuracy_quality_table(void);

// All that results depend on besides the configuration: with equal text, results can be kept. The
// program and the shaders count by size and time of change. `reference_path` is NULL for a traced
// reference image; its own error is then part of the result. NULL with a message when memory ends.
struct cJSON *accuracy_setup(const struct accuracy *accuracy, const char *reference_path,
                             const struct cJSON *identity, struct error *out_error);

struct accuracy_run {
    struct accuracy *accuracy; // its shot, folder, frames and edits; the run fills in the rest
    const struct reference_image_params *reference_image;
    const struct sweep *sweep;
    bool with_report; // write the report besides results.json
    struct accuracy_watch watch;
};

// Loads or traces the reference image, writes it as reference.png, and measures the configurations
// that are not in the folder yet. Writes the results after each. The caller owns the results; NULL
// with a message, also when the watch ended the run.
struct cJSON *accuracy_run(const struct accuracy_run *run, struct error *out_error);

#endif
