// voxcast info: what the renderer found.
#include <getopt.h>
#include <stdio.h>

#include "server/cli.h"

int cli_info(int argc, char **argv)
{
    static const struct option long_options[] = {{"gpu", required_argument, NULL, 'G'},
                                                 {"help", no_argument, NULL, 'h'},
                                                 {NULL, 0, NULL, 0}};
    const char *gpu = "auto";
    opterr = 0;
    optind = 1;
    int option;
    while ((option = getopt_long(argc, argv, "", long_options, NULL)) != -1) {
        if (option == 'h') {
            puts("usage: voxcast info [--gpu auto|software|N]");
            return 0;
        }
        if (option != 'G')
            return cli_fail(CLI_EXIT_USAGE, "unknown or incomplete option \"%s\"",
                            argv[optind - 1]);
        gpu = optarg;
    }
    if (optind < argc)
        return cli_fail(CLI_EXIT_USAGE, "unexpected argument \"%s\"", argv[optind]);
    struct error error;
    struct renderer *renderer = renderer_create(&(struct renderer_params){.gpu = gpu}, &error);
    if (!renderer)
        return cli_fail(CLI_EXIT_RENDER, "%s", error.message);
    const struct renderer_info *info = renderer_get_info(renderer);
    printf("voxcast          " VOXCAST_VERSION "\n");
    printf("GL renderer      %s%s\n", info->gl_renderer, info->software ? " (on the CPU)" : "");
    printf("GL version       %s\n", info->gl_version);
    printf("EGL              %s\n", info->egl_device);
    printf("pass timers      %s\n", info->gpu_timers ? "GPU timestamps" : "clock");
    printf("texture edge     up to %u\n", info->max_texture_edge);
    for (uint32_t i = 0; scene_builtin_name(i); i++)
        printf("%s %-22s %s\n", i == 0 ? "built-in scenes " : "                ",
               scene_builtin_name(i), scene_builtin_description(i));
    renderer_destroy(&renderer);
    return 0;
}
