// Configurations to measure: quality and settings of each.
#ifndef VOXCAST_SERVER_ACCURACY_SWEEP_H
#define VOXCAST_SERVER_ACCURACY_SWEEP_H

#include <stdint.h>
#include "renderer/renderer.h"

#define CONFIGURATION_NAME_SIZE  64u
#define CONFIGURATION_TEXT_SIZE  64u
#define CONFIGURATION_MAX_SETS   16u
#define SWEEP_MAX_CONFIGURATIONS 256u

struct cJSON;

// One configuration to measure.
struct configuration {
    char name[CONFIGURATION_NAME_SIZE]; // letters, digits, '-', '_' and '.': part of file names
    enum quality quality;
    double scale; // rendered size over shown size: 0.25 to 1, or 2
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
// where all but the name is optional. False with a message that names configuration, key and range.
bool sweep_load(const char *name, struct sweep *out_sweep, struct error *out_error);

// Applies quality and settings. The caller applies size and scale.
bool configuration_apply(const struct configuration *configuration, struct frame_params *params,
                         struct error *out_error);

// {"preset", "scale", "set"}: equal text means equal settings. The caller deletes it.
struct cJSON *configuration_json(const struct configuration *configuration);

#endif
