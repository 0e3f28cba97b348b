// Reads GLSL files and expands their includes.
#ifndef VOXCAST_RENDERER_GPU_SHADER_SOURCE_H
#define VOXCAST_RENDERER_GPU_SHADER_SOURCE_H

#include "renderer/error.h"

#include <stddef.h>
#include <stdint.h>

#define SHADER_MAX_FILES      48
#define SHADER_MAX_PATH       256
#define SHADER_MAX_FILE_BYTES (1u << 20)
#define SHADER_MAX_DEPTH      8

struct shader_source {
    char *text; // owned
    uint32_t file_count;
    char files[SHADER_MAX_FILES][SHADER_MAX_PATH]; // relative to the shader folder
};

// Reads `path` (relative to `folder`), prepends "#version 450 core" and the `define_count` texts of
// `defines` (lines of a name and a value), expands each `#include "file"` (relative to the folder)
// once, and emits #line, so that driver messages can be mapped back by file number. False with a
// message that names file and line.
bool shader_source_read(struct shader_source *source, const char *folder, const char *path,
                        const char *const defines[], uint32_t define_count,
                        struct error *out_error);
void shader_source_finish(struct shader_source *source);

// Replaces file numbers in a driver's log ("0:12(3): error", "0(12) : error") by paths.
void shader_source_map_log(const struct shader_source *source, const char *log, char *out_text,
                           size_t out_size);

#endif
