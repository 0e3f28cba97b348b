// voxcast bench: moving-camera frames of scenes, median and p95 per pass as JSON on stdout.
#include <cjson/cJSON.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "server/tool/cli_bench.h"
#include "renderer/clock.h"
#include "server/accuracy/bench_run.h"
#include "server/accuracy/shot.h"
#include "server/tool/tool_options.h"

#define DEFAULT_FRAMES 60
#define WARM_UP_FRAMES 3
#define MAX_FRAMES     10000u

static const char usage[] =
    "usage: voxcast bench [SCENE|builtin:NAME]... [OPTIONS]\n"
    "       voxcast bench natus|effects|edit|reference [OPTIONS]; see voxcast bench natus --help\n"
    "\n"
    "Measures frames of a camera that sways around its target, for each scene (default: all\n"
    "built-in ones), and prints JSON.\n"
    "\n"
    "  --frames N      frames measured per scene, 1 to 10000 (default 60)\n"
    "  --preset NAME   draft, interactive, high or final (default interactive)\n"
    "  --environment FILE   .hdr or .exr that lights the scenes\n"
    "  --gpu WHICH     auto, software or a device index (default auto)\n";

struct bench_options {
    const char *gpu, *environment;
    uint32_t frames;
    uint32_t quality;
};

static bool measure(struct renderer *renderer, const struct scene *scene,
                    const struct bench_options *options, struct cJSON *entry,
                    struct error *out_error)
{
    struct bench_run run = {.renderer = renderer,
                            .scene = scene,
                            .params = {.width = 640,
                                       .height = 360,
                                       .quality = (enum quality)options->quality,
                                       .output = FRAME_OUTPUT_YCBCR},
                            .frames = options->frames,
                            .warm_up_frames = WARM_UP_FRAMES};
    render_settings_init(&run.params.settings);
    shot_default_camera(scene, 640.0f / 360.0f, &run.params.camera);
    struct bench_result result;
    bool done = bench_measure(&run, &result, out_error);
    if (done)
        cJSON_AddItemToObject(entry, "statistics", bench_result_json(&run, &result));
    bench_result_finish(&result);
    return done;
}

static bool bench_scene(struct renderer *renderer, const char *source,
                        const struct bench_options *options, struct cJSON *list,
                        struct error *out_error)
{
    double started_ms = clock_now_ms();
    struct scene *scene = scene_load_in_environment(source, options->environment, out_error);
    if (!scene)
        return false;
    double loaded_ms = clock_now_ms();
    struct cJSON *entry = cJSON_CreateObject();
    cJSON_AddItemToArray(list, entry);
    cJSON_AddStringToObject(entry, "name", source);
    bool done = renderer_set_scene(renderer, scene, out_error);
    cJSON_AddNumberToObject(entry, "load_ms", round(loaded_ms - started_ms));
    cJSON_AddNumberToObject(entry, "upload_ms", round(clock_now_ms() - loaded_ms));
    done = done && measure(renderer, scene, options, entry, out_error);
    struct error ignored;
    renderer_set_scene(renderer, NULL, &ignored);
    scene_destroy(&scene);
    return done;
}

static int bench_scenes(struct renderer *renderer, const struct cli_parser *parser,
                        const struct bench_options *options)
{
    struct error error = {""};
    struct cJSON *root = cJSON_CreateObject();
    struct cJSON *list = cJSON_AddArrayToObject(root, "scenes");
    bool done = true;
    for (uint32_t i = 0; i < parser->argument_count && done; i++)
        done = bench_scene(renderer, parser->arguments[i], options, list, &error);
    for (uint32_t i = 0; parser->argument_count == 0 && done && scene_builtin_name(i); i++) {
        char source[128];
        snprintf(source, sizeof(source), "builtin:%s", scene_builtin_name(i));
        done = bench_scene(renderer, source, options, list, &error);
    }
    if (done)
        bench_print_json(root);
    cJSON_Delete(root);
    return done ? 0 : cli_fail(CLI_EXIT_SCENE, "%s", error.message);
}

int cli_bench(int argc, char **argv)
{
    if (argc > 1 && strcmp(argv[1], "natus") == 0)
        return bench_natus(argc - 1, argv + 1);
    if (argc > 1 && strcmp(argv[1], "effects") == 0)
        return bench_effects(argc - 1, argv + 1);
    if (argc > 1 && strcmp(argv[1], "edit") == 0)
        return bench_edit(argc - 1, argv + 1);
    if (argc > 1 && strcmp(argv[1], "reference") == 0)
        return bench_reference(argc - 1, argv + 1);
    struct bench_options options = {.frames = DEFAULT_FRAMES, .quality = QUALITY_INTERACTIVE};
    struct cli_parser parser = {
        .command = "bench", .usage = usage, .max_arguments = CLI_MAX_ARGUMENTS};
    int status;
    cli_take_count(&parser, "frames", 1, MAX_FRAMES, &options.frames);
    cli_take_preset(&parser, &options.quality);
    cli_take_gpu(&parser, &options.gpu);
    cli_take_text(&parser, "environment", &options.environment);
    if (!cli_parse(&parser, argc, argv, &status))
        return status;
    struct error error = {""};
    struct renderer *renderer =
        renderer_create(&(struct renderer_params){.gpu = options.gpu}, &error);
    if (!renderer)
        return cli_fail(CLI_EXIT_RENDER, "%s", error.message);
    status = bench_scenes(renderer, &parser, &options);
    renderer_destroy(&renderer);
    return status;
}
