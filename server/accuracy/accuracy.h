// voxcast accuracy: error against time for every configuration of a sweep.
#ifndef VOXCAST_SERVER_ACCURACY_ACCURACY_H
#define VOXCAST_SERVER_ACCURACY_ACCURACY_H

#include "renderer/metrics/display.h"
#include "server/accuracy/reference_image.h"
#include "server/accuracy/results.h"

struct cJSON;

// What all configurations of one run share.
struct accuracy {
    struct shot shot; // its settings and camera are those that configurations start from
    struct reference_image reference_image;
    bool *self_lit; // pixels near those that show emission or background: left out where indirect
                    // light is judged alone, since their edges outshine it
    struct display_params display;
    const char *folder;
    uint32_t frames; // of a moving camera that are measured
    uint32_t edits;  // of a light that are measured; 0 for none
};

// Judges an image: adds "metrics" to the object and, where the reference image's direct light is
// known, "indirect", those of what is left without `direct`. `flip_map` takes the errors of
// LDR-FLIP.
bool accuracy_judge(const struct accuracy *accuracy, const struct picture *picture,
                    const struct picture *direct, struct cJSON *object, float *flip_map,
                    struct error *out_error);

// Measures one configuration and writes its images into the folder. The entry of results.json is
// the caller's; NULL with a message.
struct cJSON *accuracy_measure(const struct accuracy *accuracy,
                               const struct configuration *configuration, struct error *out_error);

// The view of the shot, and the scene: what it was loaded from and, as KEY=VALUE, how it was
// edited.
struct cJSON *accuracy_identity(const char *source, const char *const *sets, uint32_t set_count,
                                const struct shot *shot);

// The program's quality table: by preset all that its row holds, enums by their names. The caller
// deletes it.
struct cJSON *accuracy_quality_table(void);

// All that results depend on, beside the configuration: equal text means that they can be kept.
// Program and shaders count by size and time of change. `reference_path` is NULL for a traced
// truth, whose own error is there, too. NULL with a message when memory ends.
struct cJSON *accuracy_setup(const struct accuracy *accuracy, const char *reference_path,
                             const struct cJSON *identity, struct error *out_error);

struct accuracy_run {
    struct accuracy *accuracy; // its shot, folder, frames and edits; the rest is filled meanwhile
    const struct reference_image_params *reference_image;
    const struct sweep *sweep;
    bool with_report; // beside results.json
    struct accuracy_watch watch;
};

// Gets the reference image, writes it as reference.png, and measures the configurations that are
// not in the folder yet; writes the results after each. The results are the caller's; NULL with a
// message, such as that the watch ended the run.
struct cJSON *accuracy_run(const struct accuracy_run *run, struct error *out_error);

#endif
