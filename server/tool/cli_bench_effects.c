// voxcast bench effects: what leaving out unneeded effects saves. Each scene is measured as planned
// and with every effect forced. The images are the same; time and memory are not.
#include <cjson/cJSON.h>
#include <math.h>
#include <stdio.h>

#include "server/accuracy/bench_run.h"
#include "server/accuracy/samples.h"
#include "server/accuracy/shot.h"
#include "server/tool/cli_bench.h"
#include "server/tool/tool_options.h"

#define DEFAULT_FRAMES      30
#define MAX_FRAMES          10000u
#define WARM_UP_FRAMES      3
#define MAX_CONVERGE_FRAMES 50u

static const char usage[] =
    "usage: voxcast bench effects [SCENE|builtin:NAME]... [OPTIONS]\n"
    "\n"
    "For each built-in scene, and those that are named: which effects and passes ran or were\n"
    "skipped, and why; then the median frame time of a swaying camera and the GPU memory, as\n"
    "planned and with all effects forced.\n"
    "\n"
    "  --gi METHOD     none, clipmap or grid (default as the daemon has it)\n"
    "  --preset NAME   draft, interactive, high or final (default interactive)\n"
    "  --size WxH      1x1 to 4096x2160 (default 640x360)\n"
    "  --frames N      frames measured of each, 1 to 10000 (default 30)\n"
    "  --json          JSON on stdout; the table goes to stderr\n"
    "  --environment FILE   .hdr or .exr that lights the scenes\n"
    "  --gpu WHICH     auto, software or a device index (default auto)\n";

struct effects_options {
    const char *gpu, *environment;
    struct cli_size size;
    uint32_t frames, quality;
    uint32_t gi; // CLI_NO_CHOICE: as the settings say
    bool json;
};

struct effects_bench {
    const struct effects_options *options;
    struct renderer *renderer;
    cJSON *json;
};

static double percent_less(double planned, double forced)
{
    return forced > 0.0 ? 100.0 * (1.0 - planned / forced) : 0.0;
}

// The scene is uploaded anew, so that nothing of another measurement counts as its memory.
static bool measure(struct effects_bench *bench, struct scene *scene, bool forced,
                    struct bench_result *out_result, cJSON *entry, struct error *out_error)
{
    const struct effects_options *options = bench->options;
    struct bench_run run = {.renderer = bench->renderer,
                            .scene = scene,
                            .params = {.width = options->size.width,
                                       .height = options->size.height,
                                       .quality = (enum quality)options->quality,
                                       .output = FRAME_OUTPUT_YCBCR},
                            .frames = options->frames,
                            .warm_up_frames = WARM_UP_FRAMES,
                            .max_converge_frames = MAX_CONVERGE_FRAMES};
    render_settings_init(&run.params.settings);
    if (options->gi != CLI_NO_CHOICE)
        run.params.settings.gi_method = (enum gi_method)options->gi;
    run.params.settings.force_all_effects = forced;
    shot_default_camera(scene, (float)options->size.width / (float)options->size.height,
                        &run.params.camera);
    *out_result = (struct bench_result){0};
    if (!renderer_set_scene(bench->renderer, scene, out_error) ||
        !bench_measure(&run, out_result, out_error))
        return false;
    cJSON_AddItemToObject(entry, forced ? "forced" : "planned",
                          bench_result_json(&run, out_result));
    struct error ignored;
    renderer_set_scene(bench->renderer, NULL, &ignored);
    return true;
}

static void print_reasons(FILE *file, const struct frame_statistics *statistics)
{
    for (uint32_t i = 0; i < statistics->effect_count; i++) {
        const struct effect_statistics *effect = &statistics->effects[i];
        fprintf(file, "  effect %-18s %-8s %s\n", effect->name, effect->on ? "on" : "off",
                effect->reason);
    }
    for (uint32_t i = 0; i < statistics->pass_count; i++) {
        const struct pass_statistics *pass = &statistics->passes[i];
        fprintf(file, "  pass   %-18s %-8s %s\n", pass->name, pass->ran ? "ran" : "skipped",
                pass->reason);
    }
}

static void report(FILE *file, const char *source, const struct bench_result *planned,
                   const struct bench_result *forced, cJSON *entry)
{
    double planned_ms = samples_quantile(&planned->measurement.frame_ms, 0.5);
    double forced_ms = samples_quantile(&forced->measurement.frame_ms, 0.5);
    double planned_mib = (double)bench_memory_bytes(planned) / 1048576.0;
    double forced_mib = (double)bench_memory_bytes(forced) / 1048576.0;
    fprintf(file, "%s\n", source);
    print_reasons(file, &planned->statistics);
    fprintf(file, "  frame  %.1f ms planned, %.1f ms with all effects: %.0f %% saved\n", planned_ms,
            forced_ms, percent_less(planned_ms, forced_ms));
    fprintf(file, "  memory %.1f MiB planned, %.1f MiB with all effects: %.0f %% saved\n\n",
            planned_mib, forced_mib, percent_less(planned_mib, forced_mib));
    cJSON_AddNumberToObject(entry, "frame_time_saved_percent",
                            round(10.0 * percent_less(planned_ms, forced_ms)) / 10.0);
    cJSON_AddNumberToObject(entry, "memory_saved_percent",
                            round(10.0 * percent_less(planned_mib, forced_mib)) / 10.0);
}

static bool run_scene(struct effects_bench *bench, const char *source, struct error *out_error)
{
    struct scene *scene = scene_load_in_environment(source, bench->options->environment, out_error);
    if (!scene)
        return false;
    cJSON *entry = cJSON_CreateObject();
    cJSON_AddItemToArray(bench->json, entry);
    cJSON_AddStringToObject(entry, "name", source);
    struct bench_result planned = {0}, forced = {0};
    bool done = measure(bench, scene, false, &planned, entry, out_error) &&
                measure(bench, scene, true, &forced, entry, out_error);
    if (done)
        report(bench->options->json ? stderr : stdout, source, &planned, &forced, entry);
    bench_result_finish(&planned);
    bench_result_finish(&forced);
    struct error ignored;
    renderer_set_scene(bench->renderer, NULL, &ignored);
    scene_destroy(&scene);
    return done;
}

static int run_all(struct effects_bench *bench, const struct cli_parser *parser)
{
    struct error error = {""};
    cJSON *root = cJSON_CreateObject();
    bench->json = cJSON_AddArrayToObject(root, "scenes");
    bool done = true;
    for (uint32_t i = 0; done && scene_builtin_name(i); i++) {
        char source[128];
        snprintf(source, sizeof(source), "builtin:%s", scene_builtin_name(i));
        done = run_scene(bench, source, &error);
    }
    for (uint32_t i = 0; i < parser->argument_count && done; i++)
        done = run_scene(bench, parser->arguments[i], &error);
    if (done && bench->options->json)
        bench_print_json(root);
    cJSON_Delete(root);
    return done ? 0 : cli_fail(CLI_EXIT_SCENE, "%s", error.message);
}

int bench_effects(int argc, char **argv)
{
    struct effects_options options = {.size = {640, 360},
                                      .frames = DEFAULT_FRAMES,
                                      .quality = QUALITY_INTERACTIVE,
                                      .gi = CLI_NO_CHOICE};
    struct cli_parser parser = {
        .command = "bench effects", .usage = usage, .max_arguments = CLI_MAX_ARGUMENTS};
    int status;
    cli_take_gi(&parser, &options.gi);
    cli_take_preset(&parser, &options.quality);
    cli_take_size(&parser, &options.size);
    cli_take_count(&parser, "frames", 1, MAX_FRAMES, &options.frames);
    cli_take_flag(&parser, "json", &options.json);
    cli_take_gpu(&parser, &options.gpu);
    cli_take_text(&parser, "environment", &options.environment);
    if (!cli_parse(&parser, argc, argv, &status))
        return status;
    // Its frames wait for a camera at rest, which never comes here.
    if (options.gi == GI_METHOD_REFERENCE)
        return cli_fail(CLI_EXIT_USAGE, "--gi is \"reference\"; allowed: none, clipmap, grid");
    struct error error = {""};
    struct effects_bench bench = {.options = &options};
    bench.renderer = renderer_create(&(struct renderer_params){.gpu = options.gpu}, &error);
    if (!bench.renderer)
        return cli_fail(CLI_EXIT_RENDER, "%s", error.message);
    status = run_all(&bench, &parser);
    renderer_destroy(&bench.renderer);
    return status;
}
