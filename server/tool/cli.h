// The offline tool's commands. Each returns the process's exit status: 0, or 1 to 99 after one line
// on stderr.
#ifndef VOXCAST_SERVER_TOOL_CLI_H
#define VOXCAST_SERVER_TOOL_CLI_H

#include <stdbool.h>
#include <stdint.h>

#include "renderer/renderer.h"

#define CLI_EXIT_USAGE  2
#define CLI_EXIT_SCENE  3
#define CLI_EXIT_RENDER 4
#define CLI_EXIT_OUTPUT 5

int cli_render(int argc, char **argv);
int cli_info(int argc, char **argv);
int cli_bench(int argc, char **argv);
int cli_shaders(int argc, char **argv);
int cli_compare(int argc, char **argv);
int cli_accuracy(int argc, char **argv);
int cli_stability(int argc, char **argv); // in server/tool/stability/, with its cases

// Prints one line to stderr and returns `status`.
int cli_fail(int status, const char *format, ...) __attribute__((format(printf, 2, 3)));

#endif
