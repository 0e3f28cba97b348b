// voxcast info: what the renderer found, or what the presets are.
#include <cjson/cJSON.h>
#include <stdio.h>

#include "server/accuracy/accuracy.h"
#include "server/tool/cli.h"
#include "server/tool/tool_options.h"

static const char usage[] =
    "usage: voxcast info [--gpu auto|software|N] [--quality]\n"
    "\n"
    "Shows the GL renderer, its limits and the built-in scenes.\n"
    "\n"
    "  --gpu auto|software|N   which one (default auto)\n"
    "  --quality               print the quality table instead, as JSON: what each preset is.\n"
    "                          Needs no GL\n";

static int print_quality_table(void)
{
    cJSON *table = accuracy_quality_table();
    char *text = cJSON_Print(table);
    cJSON_Delete(table);
    if (!text)
        return cli_fail(CLI_EXIT_OUTPUT, "out of memory");
    puts(text);
    cJSON_free(text);
    return 0;
}

int cli_info(int argc, char **argv)
{
    const char *gpu;
    bool quality = false;
    struct cli_parser parser = {.command = "info", .usage = usage};
    int status;
    cli_take_gpu(&parser, &gpu);
    cli_take_flag(&parser, "quality", &quality);
    if (!cli_parse(&parser, argc, argv, &status))
        return status;
    if (quality)
        return print_quality_table();
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
