// voxcast bench reference: how many rays per second the path tracer casts, compared with a bare
// Embree loop over the same rays on the same scene. Both take turns within one run.
#include <cjson/cJSON.h>
#include <math.h>
#include <stdio.h>

#include "renderer/clock.h"
#include "renderer/path_tracer/ray_bench.h"
#include "server/accuracy/bench_run.h"
#include "server/accuracy/samples.h"
#include "server/accuracy/shot.h"
#include "server/tool/cli_bench.h"
#include "server/tool/tool_options.h"

#define DEFAULT_ROUNDS 5
#define MAX_ROUNDS     1000u
#define DEFAULT_SPP    4
#define MAX_SPP        64u

static const char usage[] =
    "usage: voxcast bench reference [SCENE|builtin:NAME]... [OPTIONS]\n"
    "\n"
    "For each scene (default: all built-in ones) records the rays of an image by the reference\n"
    "path tracer, then casts them in turns by a bare Embree loop and by the path tracer itself,\n"
    "on all processors. Prints JSON: medians of millions of rays per second, of their ratio, and\n"
    "of that by processor time, which holds on a busy machine, too; for direct light (primary\n"
    "and shadow rays) and for light of all bounces.\n"
    "\n"
    "  --environment FILE   .hdr or .exr that lights the scenes\n"
    "  --size WxH      1x1 to 4096x2160 (default 640x360)\n"
    "  --spp N         samples per pixel and round, 1 to 64 (default 4)\n"
    "  --rounds N      1 to 1000 (default 5)\n"
    "  --threads N     1 to 256 (default: as many as there are processors)\n";

struct reference_bench {
    const char *environment;
    struct cli_size size;
    uint32_t spp, rounds, threads;
};

struct rate_samples {
    struct samples bare, reference, ratio, cpu_ratio;
};

static bool add_round(struct rate_samples *samples, const struct ray_rate_result *round)
{
    double rays = (double)(round->nearest_rays + round->shadow_rays) * 1e-6;
    return samples_add(&samples->bare, rays / round->bare_seconds) &&
           samples_add(&samples->reference, rays / round->reference_seconds) &&
           samples_add(&samples->ratio, round->bare_seconds / round->reference_seconds) &&
           samples_add(&samples->cpu_ratio, round->bare_cpu_seconds / round->reference_cpu_seconds);
}

static void add_median(cJSON *entry, const char *name, struct samples *samples)
{
    cJSON_AddNumberToObject(entry, name, round(1000.0 * samples_quantile(samples, 0.5)) / 1000.0);
    samples_finish(samples);
}

static bool measure(const struct reference_bench *bench, const struct reference_params *params,
                    cJSON *entry, struct error *out_error)
{
    struct ray_rate *rate = ray_rate_create(params, bench->spp, out_error);
    struct rate_samples samples = {0};
    struct ray_rate_result result = {0};
    bool done = rate != NULL;
    for (uint32_t i = 0; done && i < bench->rounds; i++)
        done = ray_rate_measure(rate, &result, out_error) &&
               (add_round(&samples, &result) || error_set(out_error, "out of memory"));
    cJSON_AddNumberToObject(entry, "nearest_rays", (double)result.nearest_rays);
    cJSON_AddNumberToObject(entry, "shadow_rays", (double)result.shadow_rays);
    add_median(entry, "bare_embree_mrays_per_s", &samples.bare);
    add_median(entry, "reference_mrays_per_s", &samples.reference);
    add_median(entry, "ratio", &samples.ratio);
    add_median(entry, "processor_time_ratio", &samples.cpu_ratio);
    if (rate)
        ray_rate_destroy(&rate);
    return done;
}

static bool bench_scene(const struct reference_bench *bench, const char *source, cJSON *list,
                        struct error *out_error)
{
    struct scene *scene = scene_load_in_environment(source, bench->environment, out_error);
    if (!scene)
        return false;
    struct reference_params params = {
        .width = bench->size.width, .height = bench->size.height, .threads = bench->threads};
    shot_default_camera(scene, (float)params.width / (float)params.height, &params.camera);
    double started_ms = clock_now_ms();
    params.scene = snapshot_create(scene, false, out_error);
    cJSON *entry = cJSON_CreateObject();
    cJSON_AddItemToArray(list, entry);
    cJSON_AddStringToObject(entry, "name", source);
    cJSON_AddNumberToObject(entry, "triangles", (double)scene_triangle_count(scene));
    cJSON_AddNumberToObject(entry, "snapshot_ms", round(clock_now_ms() - started_ms));
    scene_destroy(&scene);
    if (!params.scene)
        return false;
    params.estimator = REFERENCE_LIGHT_SAMPLING;
    bool done = measure(bench, &params, cJSON_AddObjectToObject(entry, "direct_light"), out_error);
    params.estimator = REFERENCE_MIS;
    params.max_bounces = REFERENCE_UNLIMITED;
    done =
        done && measure(bench, &params, cJSON_AddObjectToObject(entry, "all_bounces"), out_error);
    snapshot_release(&params.scene);
    return done;
}

int bench_reference(int argc, char **argv)
{
    struct reference_bench bench = {
        .size = {640, 360}, .spp = DEFAULT_SPP, .rounds = DEFAULT_ROUNDS};
    struct cli_parser parser = {
        .command = "bench reference", .usage = usage, .max_arguments = CLI_MAX_ARGUMENTS};
    int status;
    cli_take_size(&parser, &bench.size);
    cli_take_text(&parser, "environment", &bench.environment);
    cli_take_count(&parser, "spp", 1, MAX_SPP, &bench.spp);
    cli_take_count(&parser, "rounds", 1, MAX_ROUNDS, &bench.rounds);
    cli_take_count(&parser, "threads", 1, REFERENCE_MAX_THREADS, &bench.threads);
    if (!cli_parse(&parser, argc, argv, &status))
        return status;
    struct error error = {""};
    cJSON *root = cJSON_CreateObject();
    cJSON *list = cJSON_AddArrayToObject(root, "scenes");
    bool done = true;
    for (uint32_t i = 0; i < parser.argument_count && done; i++)
        done = bench_scene(&bench, parser.arguments[i], list, &error);
    for (uint32_t i = 0; parser.argument_count == 0 && done && scene_builtin_name(i); i++) {
        char source[128];
        snprintf(source, sizeof(source), "builtin:%s", scene_builtin_name(i));
        done = bench_scene(&bench, source, list, &error);
    }
    if (done)
        bench_print_json(root);
    cJSON_Delete(root);
    return done ? 0 : cli_fail(CLI_EXIT_RENDER, "%s", error.message);
}
