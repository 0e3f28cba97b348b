// The daemon's options: flags, environment (VOXCASTD_*), and a file of key = value lines.
#ifndef VOXCAST_SERVER_OPTIONS_H
#define VOXCAST_SERVER_OPTIONS_H

#include <stdbool.h>
#include <stdint.h>

#include "renderer/renderer.h"

#define OPTIONS_TEXT_SIZE 1024u

#define OPTIONS_DEFAULT_SCENE "builtin:cornell-objects"

struct options {
    char scene[OPTIONS_TEXT_SIZE];
    char environment[OPTIONS_TEXT_SIZE]; // .hdr or .exr; "" for the scene's own
    char listen[OPTIONS_TEXT_SIZE];      // address
    uint32_t port;                       // 0: any free one
    char gpu[OPTIONS_TEXT_SIZE];
    char scene_dir[OPTIONS_TEXT_SIZE]; // "" for none; likewise below
    char web_dir[OPTIONS_TEXT_SIZE];
    char token_file[OPTIONS_TEXT_SIZE];
    char viewer_token_file[OPTIONS_TEXT_SIZE];
    char allow_origin[OPTIONS_TEXT_SIZE]; // origins, separated by commas
    uint32_t max_clients;
    uint32_t message_bytes;
    uint32_t queue_bytes;  // limit of replies that wait for one client
    uint32_t message_rate; // a second, for each client
    uint32_t jpeg_quality;
    uint32_t jpeg_threads;
    uint32_t scene_cache_mib; // 0: no cache
    enum log_level log_level;
};

enum options_result {
    OPTIONS_RUN,
    OPTIONS_HELP,    // --help was asked for
    OPTIONS_VERSION, // --version was asked for
    OPTIONS_WRONG,
};

// Flags win over the environment, which wins over the file, which wins over the defaults.
// `environment` has the form of environ. On OPTIONS_WRONG the message names option, value and
// range.
enum options_result options_read(int argument_count, char *const *arguments,
                                 char *const *environment, struct options *out_options,
                                 struct error *out_error);

// Writes the text of --help, at most `size` bytes.
void options_write_help(char *out, size_t size);

#endif
