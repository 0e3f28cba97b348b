// voxcast: the offline tool. Renders images, measures, and reports on the GPU.
#include <stdio.h>
#include <string.h>

#include "renderer/renderer.h"
#include "server/tool/cli.h"

static const char usage[] =
    "usage: voxcast COMMAND [OPTIONS]\n"
    "\n"
    "  render SCENE --out FILE   render a scene (glTF, GLB, OBJ or builtin:NAME) to .pfm, .png or\n"
    "                            .jpg; see voxcast render --help\n"
    "  info                      show the GL renderer, its limits and the built-in scenes, or\n"
    "                            (--quality) what the presets are\n"
    "  bench [natus|effects|edit]\n"
    "                            measure frames; JSON or tables on stdout; see\n"
    "                            voxcast bench --help\n"
    "  compare A.pfm B.pfm       tell how far an image is from a reference; see\n"
    "                            voxcast compare --help\n"
    "  accuracy SCENE --out DIR  error against time for every setting; see\n"
    "                            voxcast accuracy --help\n"
    "  stability                 small scenes that try to break the numbers; see\n"
    "                            voxcast stability --help\n"
    "  shaders [SCENE]           have the driver compile what a scene's first frames need; see\n"
    "                            voxcast shaders --help\n"
    "  --version                 print the version\n";

int main(int argc, char **argv)
{
    renderer_prepare_process(argv);
    log_set_level(LOG_ERROR);
    if (argc < 2 || strcmp(argv[1], "--help") == 0 || strcmp(argv[1], "-h") == 0 ||
        strcmp(argv[1], "help") == 0) {
        fputs(usage, argc < 2 ? stderr : stdout);
        return argc < 2 ? CLI_EXIT_USAGE : 0;
    }
    if (strcmp(argv[1], "--version") == 0) {
        puts("voxcast " VOXCAST_VERSION);
        return 0;
    }
    static const struct {
        const char *name;
        int (*run)(int argc, char **argv);
    } commands[] = {{"render", cli_render},     {"info", cli_info},
                    {"bench", cli_bench},       {"compare", cli_compare},
                    {"accuracy", cli_accuracy}, {"stability", cli_stability},
                    {"shaders", cli_shaders}};
    for (size_t i = 0; i < sizeof(commands) / sizeof(commands[0]); i++)
        if (strcmp(argv[1], commands[i].name) == 0)
            return commands[i].run(argc - 1, argv + 1);
    return cli_fail(CLI_EXIT_USAGE,
                    "unknown command \"%s\"; known are render, info, bench, compare, accuracy, "
                    "stability and shaders",
                    argv[1]);
}
