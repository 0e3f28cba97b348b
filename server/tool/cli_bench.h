// The benches.
#ifndef VOXCAST_SERVER_TOOL_CLI_BENCH_H
#define VOXCAST_SERVER_TOOL_CLI_BENCH_H

#include <stdbool.h>
#include <stdint.h>

#include "server/tool/cli.h"

// The benches. Like all commands of cli.h; argv[0] is the bench's name.
int bench_natus(int argc, char **argv);
int bench_effects(int argc, char **argv);
int bench_edit(int argc, char **argv);
int bench_reference(int argc, char **argv);

#endif
