// voxcast accuracy: error against time for every setting of a ladder. The parts that its command
// (cli_accuracy.c) puts together; results are kept as JSON, as results.json has them.
#ifndef VOXCAST_SERVER_ACCURACY_H
#define VOXCAST_SERVER_ACCURACY_H

#include "server/cli_shot.h"

#define CONFIGURATION_NAME_SIZE  64u
#define CONFIGURATION_TEXT_SIZE  64u
#define CONFIGURATION_MAX_SETS   16u
#define SWEEP_MAX_CONFIGURATIONS 256u

// Noise of the truth over the smallest error, up to which errors are believed.
#define RESULTS_NOISE_FRACTION 0.1

struct cJSON;

// One setting that is measured.
struct configuration {
    char name[CONFIGURATION_NAME_SIZE]; // letters, digits, '-', '_' and '.': names its files
    enum quality quality;
    double scale; // size it is rendered at over the size shown: 0.25 to 1, or 2
    uint32_t set_count;
    struct {
        char key[CONFIGURATION_TEXT_SIZE], value[CONFIGURATION_TEXT_SIZE]; // a field of settings
    } sets[CONFIGURATION_MAX_SETS];
};

struct sweep {
    uint32_t configuration_count;
    struct configuration configurations[SWEEP_MAX_CONFIGURATIONS];
};

// "quick" (the presets), "full" (methods, voxels, gather modes, cones, steps, bounces, levels and
// scales, in turn), or a file: a JSON array of {"name", "preset", "scale", "set": {"KEY": VALUE}},
// all but the name optional. False with a message that names rung, key and range.
bool sweep_load(const char *name, struct sweep *out_sweep, struct error *out_error);

// Applies quality and sets; size and scale are the caller's.
bool configuration_apply(const struct configuration *configuration, struct frame_params *params,
                         struct error *out_error);

// {"preset", "scale", "set"}: equal text means equal settings. The caller deletes it.
struct cJSON *configuration_json(const struct configuration *configuration);

// What pictures are compared with. Those but the first have no pixels if they are not known.
enum reference_picture {
    REFERENCE_IMAGE_ALL,
    REFERENCE_IMAGE_DIRECT, // emission, background, and light of lights and emitters reflected once
    // Of one half of the samples. It differs from the whole as much as the whole does from what it
    // would be without noise: the halves are independent, so that half of their difference is both.
    REFERENCE_IMAGE_HALF,
    REFERENCE_IMAGE_HALF_DIRECT,
    REFERENCE_IMAGE_PICTURE_COUNT
};

struct reference_image {
    struct picture pictures[REFERENCE_IMAGE_PICTURE_COUNT];
    double noise; // standard error over mean luminance; NaN if that is not known
};

enum accuracy_stage {
    ACCURACY_TRACING,   // the truth; about twice a second
    ACCURACY_TRACED,    // or loaded
    ACCURACY_MEASURING, // rungs: before the first, and after each
};

// How far a run has come.
struct accuracy_progress {
    enum accuracy_stage stage;
    uint32_t samples;                     // of the truth, a pixel; 0 if it was loaded
    double noise;                         // of the truth; not finite while it is not known
    uint32_t done, configuration_count;   // rungs
    const struct configuration *measured; // the newest, in this run; NULL for none
    const struct configuration *next;     // NULL at the end
    double measured_s;                    // what `measured` took
    double left_s;                        // of this stage; NaN while it is not known
};

// Who is told how a run goes on, and may end it. Zero: nobody.
struct accuracy_watch {
    bool (*tell)(void *user, const struct accuracy_progress *progress); // false ends the run
    void *user;
};

struct reference_image_params {
    const struct cli_shot *shot;
    const char *path, *direct_path; // files; NULL to trace
    uint32_t samples;               // a pixel, if until_noise is 0
    double until_noise;             // trace until the noise is no more than this
    double max_s;                   // or for so long; 0: however long that takes
    const char *folder;             // where a traced picture is kept, and found again, or NULL
    const struct cJSON *identity;   // says what scene and view is traced
    bool low_priority;              // gives way to all others
    struct accuracy_watch watch;
};

// Loads or traces the truth. Tracing takes all processors. False with a message, such as that a
// file is of another size, or that the watch ended it; then nothing needs finishing.
bool reference_image_get(const struct reference_image_params *params,
                         struct reference_image *out_reference, struct error *out_error);
void reference_image_finish(struct reference_image *reference_image);

// What all rungs of one run share.
struct accuracy {
    struct cli_shot shot; // its settings and camera are those that rungs start from
    struct reference_image reference_image;
    bool *self_lit; // pixels near those that show emission or background: left out where indirect
                    // light is judged alone, since their edges outshine it
    struct display_params display;
    const char *folder;
    uint32_t frames; // of a moving camera that are measured
    uint32_t edits;  // of a light that are measured; 0 for none
};

// Judges a picture: adds "metrics" to the object and, where the truth's direct light is known,
// "indirect", those of what is left without `direct`. `flip_map` takes the errors of LDR-FLIP.
bool accuracy_judge(const struct accuracy *accuracy, const struct picture *picture,
                    const struct picture *direct, struct cJSON *object, float *flip_map,
                    struct error *out_error);

// Measures one rung and writes its pictures into the folder. The entry of results.json is the
// caller's; NULL with a message.
struct cJSON *accuracy_measure(const struct accuracy *accuracy,
                               const struct configuration *configuration, struct error *out_error);

// The view of the shot, and the scene: what it was loaded from and, as KEY=VALUE, how it was
// edited.
struct cJSON *accuracy_identity(const char *source, const struct cli_sets *sets,
                                const struct cli_shot *shot);

// The program's quality table: by preset all that its row holds, enums by their names. The caller
// deletes it.
struct cJSON *accuracy_quality_table(void);

// All that results depend on, beside the rung: equal text means that they can be kept. Program and
// shaders count by size and time of change. `reference_path` is NULL for a traced truth, whose own
// error is there, too. NULL with a message when memory ends.
struct cJSON *accuracy_setup(const struct accuracy *accuracy, const char *reference_path,
                             const struct cJSON *identity, struct error *out_error);

// Results of a run: {"setup", "metrics", "rungs", "noise"}; the last compares the noise of the
// truth with the smallest error of a final picture, both over the mean of the truth.
//
// Reads the folder's results.json if it is of the same set-up, else starts anew. `setup` is taken
// over. `out_kept` says how many rungs are there already.
struct cJSON *results_open(const char *folder, struct cJSON *setup, uint32_t *out_kept);

// The rung's entry, or NULL.
const struct cJSON *results_find(const struct cJSON *results,
                                 const struct configuration *configuration);

// Adds an entry (taken over) in the place of one of the same name, and marks the Pareto front of
// each metric anew: rungs than which none is both faster and less wrong.
void results_add(struct cJSON *results, struct cJSON *entry);

// Writes results.json: whole, or it stays as it was.
bool results_write(const struct cJSON *results, const char *folder, struct error *out_error);

// Writes results.csv and the page: index.html, its scripts, results.js.
bool results_write_report(const struct cJSON *results, const char *folder, struct error *out_error);

struct accuracy_run {
    struct accuracy *accuracy; // its shot, folder, frames and edits; the rest is filled meanwhile
    const struct reference_image_params *reference_image;
    const struct sweep *sweep;
    bool with_report; // beside results.json
    struct accuracy_watch watch;
};

// Gets the truth, writes it as reference.png, and measures the rungs that are not in the folder
// yet; writes the results after each. The results are the caller's; NULL with
// a message, such as that the watch ended the run.
struct cJSON *accuracy_run(const struct accuracy_run *run, struct error *out_error);

#endif
