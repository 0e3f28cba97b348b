// A scene, a renderer that shows it, and the frame that the options of a command ask for.
#ifndef VOXCAST_SERVER_TOOL_SHOT_OPTIONS_H
#define VOXCAST_SERVER_TOOL_SHOT_OPTIONS_H

#include "server/accuracy/shot.h"
#include "server/tool/tool_options.h"

struct cli_shot_options {
    const char *source;      // file or builtin:NAME
    const char *environment; // file of an equirectangular image; NULL for the scene's own
    const char *gpu;
    struct cli_size size;
    struct cli_camera camera;
    struct cli_settings settings;
    uint32_t scene_cache_mib; // 0: no cache
};

// Declares --size, --gpu, --environment, --scene-cache-mib and the options of camera and settings;
// initializes all but the size.
void cli_take_shot(struct cli_parser *parser, struct cli_shot_options *target);

// Opens the scene cache, loads the scene, prints its warnings and applies the options; starts no
// renderer. `preset` is the quality if none is asked for. Returns the exit status: 0, or that of a
// message on stderr; then nothing needs closing.
int cli_shot_load(const struct cli_shot_options *options, enum quality preset,
                  struct shot *out_shot);

// Starts the renderer of a loaded shot. Closes the shot on failure.
int cli_shot_start(const struct cli_shot_options *options, struct shot *shot);

// Both of the above.
int cli_shot_open(const struct cli_shot_options *options, enum quality preset,
                  struct shot *out_shot);

#endif
