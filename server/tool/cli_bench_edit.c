// voxcast bench edit: how soon an image shows that a light was edited, and how soon the change is
// complete.
#include <cjson/cJSON.h>
#include <math.h>
#include <stdio.h>

#include "server/accuracy/bench_run.h"
#include "server/tool/cli_bench.h"
#include "server/accuracy/edit_latency.h"
#include "server/tool/shot_options.h"

#define DEFAULT_REPETITIONS 10

static const char usage[] =
    "usage: voxcast bench edit SCENE|builtin:NAME [OPTIONS]\n"
    "\n"
    "Draws a still view until its light has settled, edits a light, and draws until it has "
    "settled\n"
    "again; then takes the edit back, and so on. Images are compared as linear radiance by the\n"
    "exposure of the first, clipped at 1. The change between two converged images is their mean\n"
    "absolute difference. Printed are, with median and p95 over the repetitions:\n"
    "\n"
    "  first      time and frames until 1 % of the change is in the image\n"
    "  arrived    until 95 % of it are there and stay\n"
    "  indirect   until 95 % of the change of indirect light alone are there and stay\n"
    "  settled    until nothing more changes\n"
    "\n"
    "Times are those of drawing and reading back, from the edit on; frames are drawn one after\n"
    "another. Encoding and network come on top.\n"
    "\n"
    "  --edit WHAT     color (times 0.2, 0.6, 1) or intensity (times 0.25); default color\n"
    "  --light N       the light that is edited (default: the first that shines)\n"
    "  --material N    the emissive material that is edited (default where no light shines)\n"
    "  --repetitions N 2 to 1000 edits measured (default 10)\n"
    "  --size WxH      1x1 to 4096x2160 (default 640x360)\n"
    "  --preset NAME   draft, interactive, high or final (default interactive)\n"
    "  --json          JSON on stdout\n"
    "  --environment, --camera, --eye, --target, --up, --fov-y-deg, --gi, --set, --gpu\n"
    "                  as voxcast render\n";

struct edit_options {
    struct cli_shot_options shot;
    uint32_t kind, light, material, repetitions;
    bool json;
};

static double rounded(double ms)
{
    return round(10.0 * ms) / 10.0;
}

static void print_table(const struct edit_options *options, const struct shot *shot,
                        const struct edit_result *result)
{
    bool light = result->light != SCENE_NONE;
    printf("%s, %s, %ux%u, %s quality, %s of %s %u, %u edits, change %.3f of white\n\n"
           "             median ms   p95 ms   median frames   p95 frames\n",
           options->shot.source, renderer_get_info(shot->renderer)->gl_renderer, shot->params.width,
           shot->params.height, quality_names[shot->params.quality], edit_kind_names[options->kind],
           light ? "light" : "material", light ? result->light : result->material,
           options->repetitions, result->change);
    for (int i = 0; i < EDIT_STAGE_COUNT; i++)
        printf("%-10s %11.1f %8.1f %15.0f %12.0f\n", edit_stage_names[i],
               samples_quantile(&result->ms[i], 0.5), samples_quantile(&result->ms[i], 0.95),
               samples_quantile(&result->frames[i], 0.5),
               samples_quantile(&result->frames[i], 0.95));
}

static void print_json(const struct edit_options *options, const struct shot *shot,
                       const struct edit_result *result)
{
    bool light = result->light != SCENE_NONE;
    cJSON *root = cJSON_CreateObject();
    cJSON_AddStringToObject(root, "gl_renderer", renderer_get_info(shot->renderer)->gl_renderer);
    cJSON_AddStringToObject(root, "scene", options->shot.source);
    cJSON_AddStringToObject(root, "quality", quality_names[shot->params.quality]);
    cJSON_AddNumberToObject(root, "width", shot->params.width);
    cJSON_AddNumberToObject(root, "height", shot->params.height);
    cJSON_AddStringToObject(root, "edit", edit_kind_names[options->kind]);
    cJSON_AddNumberToObject(root, light ? "light" : "material",
                            light ? result->light : result->material);
    cJSON_AddNumberToObject(root, "repetitions", options->repetitions);
    cJSON_AddNumberToObject(root, "change", result->change);
    for (int i = 0; i < EDIT_STAGE_COUNT; i++) {
        const struct samples *ms = &result->ms[i], *frames = &result->frames[i];
        cJSON *stage = cJSON_AddObjectToObject(root, edit_stage_names[i]);
        cJSON_AddNumberToObject(stage, "median_ms", rounded(samples_quantile(ms, 0.5)));
        cJSON_AddNumberToObject(stage, "p95_ms", rounded(samples_quantile(ms, 0.95)));
        cJSON_AddNumberToObject(stage, "median_frames", samples_quantile(frames, 0.5));
        cJSON_AddNumberToObject(stage, "p95_frames", samples_quantile(frames, 0.95));
    }
    bench_print_json(root);
    cJSON_Delete(root);
}

static int measure(const struct edit_options *options, struct shot *shot)
{
    struct error error = {""};
    struct edit_params params = {.renderer = shot->renderer,
                                 .scene = shot->scene,
                                 .frame = &shot->params,
                                 .kind = (enum edit_kind)options->kind,
                                 .light = options->light,
                                 .material = options->material,
                                 .repetitions = options->repetitions};
    struct edit_result result;
    int status = 0;
    if (!edit_measure(&params, &result, &error))
        status = cli_fail(CLI_EXIT_RENDER, "%s", error.message);
    else if (options->json)
        print_json(options, shot, &result);
    else
        print_table(options, shot, &result);
    edit_result_finish(&result);
    return status;
}

int bench_edit(int argc, char **argv)
{
    struct edit_options options = {.shot.size = {640, 360},
                                   .light = SCENE_NONE,
                                   .material = SCENE_NONE,
                                   .repetitions = DEFAULT_REPETITIONS};
    struct shot shot;
    struct cli_parser parser = {.command = "bench edit", .usage = usage, .max_arguments = 1};
    int status;
    cli_take_shot(&parser, &options.shot);
    cli_take_choice(&parser, "edit", edit_kind_names, EDIT_KIND_COUNT, &options.kind);
    cli_take_count(&parser, "light", 0, SCENE_MAX_LIGHTS - 1, &options.light);
    cli_take_count(&parser, "material", 0, SCENE_MAX_MATERIALS - 1, &options.material);
    cli_take_count(&parser, "repetitions", 2, 1000, &options.repetitions);
    cli_take_flag(&parser, "json", &options.json);
    if (!cli_parse(&parser, argc, argv, &status))
        return status;
    if (parser.argument_count == 0)
        return cli_fail(CLI_EXIT_USAGE, "no scene given; see voxcast bench edit --help");
    options.shot.source = parser.arguments[0];
    status = cli_shot_open(&options.shot, QUALITY_INTERACTIVE, &shot);
    if (status != 0)
        return status;
    status = measure(&options, &shot);
    shot_close(&shot);
    return status;
}
