// voxcast info: what the renderer found.
#include <stdio.h>

#include "server/cli.h"
#include "server/cli_options.h"

int cli_info(int argc, char **argv)
{
    const char *gpu;
    struct cli_parser parser = {.command = "info",
                                .usage = "usage: voxcast info [--gpu auto|software|N]\n"};
    int status;
    cli_take_gpu(&parser, &gpu);
    if (!cli_parse(&parser, argc, argv, &status))
        return status;
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
