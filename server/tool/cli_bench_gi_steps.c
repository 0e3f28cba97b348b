// voxcast bench natus: what each step of voxel global illumination costs in a Cornell box, by the
// resolution of the voxels, with voxels that are kept or rebuilt for each frame.
#include <cjson/cJSON.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/accuracy/bench_run.h"
#include "server/accuracy/samples.h"
#include "server/accuracy/shot.h"
#include "server/tool/cli_bench.h"
#include "server/tool/tool_options.h"

#define DEFAULT_FRAMES  30
#define MAX_FRAMES      10000u
#define WARM_UP_FRAMES  3
#define CONVERGE_FRAMES 100
#define MAX_ROWS        32u
#define COLUMN_WIDTH    10
#define LIGHT_RADIUS_M  0.1f

static const char usage[] =
    "usage: voxcast bench natus [OPTIONS]\n"
    "\n"
    "Measures a camera that sways in a Cornell box, after its light has converged: 1 direct light\n"
    "only; 2 indirect light by a voxel grid, reflection and refraction; 3 soft shadows, too;\n"
    "4 ambient occlusion, too; 5 as 4, lit by an emissive wall alone (its shadows are soft by the\n"
    "voxels' light itself, without cones towards a light). Tests 2 to 5 run with voxels that are\n"
    "kept and with voxels made anew for each frame. Times are medians in milliseconds.\n"
    "\n"
    "Quality is high, whose row allows soft shadows, with gather mode cache, so that all tests\n"
    "gather diffuse light alike. A light without a size is given a radius of 0.1 m. A test whose\n"
    "frames lack an effect that it names, or have one that it does not, fails.\n"
    "\n"
    "  --scene FILE    the box (default $VOXCAST_SCENES/natus-cornell/natus-cornell.glb); the\n"
    "                  same name with -emissive before its extension is lit by the wall\n"
    "  --size WxH      1x1 to 4096x2160 (default 1024x768)\n"
    "  --voxels N      only this resolution: 64, 128 or 256 (auto: all)\n"
    "  --frames N      frames measured in each row, 1 to 10000 (default 30)\n"
    "  --converge N    frames drawn before, unless it has converged, 0 to 10000 (default 100)\n"
    "  --json          JSON on stdout; the table goes to stderr\n"
    "  --gpu WHICH     auto, software or a device index (default auto)\n";

struct natus_options {
    char scene[1024], emissive_scene[1024 + 16];
    const char *gpu;
    struct cli_size size;
    uint32_t frames, converge_frames;
    uint32_t voxels; // an enum voxel_resolution; auto: all
    bool json;
};

static const struct natus_test {
    uint32_t number;
    const char *name;
    enum gi_method method;
    bool ambient_occlusion;
    bool emissive; // lit by the emissive wall, else by the light
    bool soft_shadows;
} tests[] = {
    {1, "direct light", GI_METHOD_NONE, false, false, false},
    {2, "indirect light", GI_METHOD_GRID, false, false, false},
    {3, "+ soft shadows", GI_METHOD_GRID, false, false, true},
    {4, "+ ambient occlusion", GI_METHOD_GRID, true, false, true},
    {5, "emissive wall", GI_METHOD_GRID, true, true, false},
};

#define TEST_COUNT (sizeof(tests) / sizeof(tests[0]))

struct natus_row {
    const struct natus_test *test;
    enum voxel_resolution voxels;
    bool every_frame;
    struct bench_result result;
    struct error error; // "" if it was measured
};

struct natus {
    const struct natus_options *options;
    struct renderer *renderer;
    uint32_t row_count;
    struct natus_row rows[MAX_ROWS];
    cJSON *json;
};

static bool effect_is_on(const struct frame_statistics *statistics, const char *name)
{
    for (uint32_t i = 0; i < statistics->effect_count; i++)
        if (strcmp(statistics->effects[i].name, name) == 0)
            return statistics->effects[i].on;
    return false;
}

static const char *effect_reason(const struct frame_statistics *statistics, const char *name)
{
    for (uint32_t i = 0; i < statistics->effect_count; i++)
        if (strcmp(statistics->effects[i].name, name) == 0)
            return statistics->effects[i].reason;
    return "there is no such effect";
}

// Whether the frames had exactly those of these effects that the test names.
static bool check_effects(const struct natus_test *test, const struct frame_statistics *statistics,
                          struct error *out_error)
{
    bool indirect = test->method != GI_METHOD_NONE;
    const struct {
        const char *name;
        bool wanted;
    } wanted[] = {{"indirect_diffuse", indirect},
                  {"indirect_specular", indirect},
                  {"refraction", indirect},
                  {"soft_shadows", test->soft_shadows},
                  {"ambient_occlusion", test->ambient_occlusion},
                  {"punctual_lights", !test->emissive}};
    for (size_t i = 0; i < sizeof(wanted) / sizeof(wanted[0]); i++)
        if (effect_is_on(statistics, wanted[i].name) != wanted[i].wanted)
            return error_set(out_error, "test %u needs %s %s, but it is %s: %s", test->number,
                             wanted[i].name, wanted[i].wanted ? "on" : "off",
                             wanted[i].wanted ? "off" : "on",
                             effect_reason(statistics, wanted[i].name));
    return true;
}

// Soft shadows need lights that have a size.
static void give_lights_a_size(struct scene *scene)
{
    for (uint32_t i = 0; i < scene->light_count; i++) {
        struct scene_light light = scene->lights[i];
        if (light.radius_m == 0.0f) {
            light.radius_m = LIGHT_RADIUS_M;
            scene_set_light(scene, i, &light);
        }
    }
}

static void take_row(struct natus *natus, const struct scene *scene, const struct natus_test *test,
                     enum voxel_resolution voxels, bool every_frame)
{
    struct natus_row *row = &natus->rows[natus->row_count++];
    *row = (struct natus_row){.test = test, .voxels = voxels, .every_frame = every_frame};
    struct bench_run run = {.renderer = natus->renderer,
                            .scene = scene,
                            .params = {.width = natus->options->size.width,
                                       .height = natus->options->size.height,
                                       .quality = QUALITY_HIGH,
                                       .output = FRAME_OUTPUT_YCBCR},
                            .frames = natus->options->frames,
                            .warm_up_frames = WARM_UP_FRAMES,
                            .max_converge_frames = natus->options->converge_frames};
    struct render_settings *settings = &run.params.settings;
    render_settings_init(settings);
    settings->gi_method = test->method;
    settings->voxel_resolution = voxels;
    settings->voxel_directions = VOXEL_ISOTROPIC;
    settings->voxelize_every_frame = every_frame;
    settings->gather_mode = GATHER_CACHE;
    settings->soft_shadows = test->soft_shadows;
    settings->ambient_occlusion = test->ambient_occlusion;
    shot_default_camera(scene, (float)run.params.width / (float)run.params.height,
                        &run.params.camera);
    fprintf(stderr, "voxcast: test %u, %s voxels%s\n", test->number, voxel_resolution_names[voxels],
            every_frame ? ", made for each frame" : "");
    cJSON *entry = cJSON_CreateObject();
    cJSON_AddItemToArray(natus->json, entry);
    cJSON_AddNumberToObject(entry, "test", test->number);
    cJSON_AddStringToObject(entry, "name", test->name);
    cJSON_AddStringToObject(entry, "voxels", voxel_resolution_names[voxels]);
    cJSON_AddBoolToObject(entry, "voxelize_every_frame", every_frame);
    if (!bench_measure(&run, &row->result, &row->error) ||
        !check_effects(test, &row->result.statistics, &row->error)) {
        cJSON_AddStringToObject(entry, "error", row->error.message);
        return;
    }
    double median_ms = samples_quantile(&row->result.measurement.frame_ms, 0.5);
    cJSON_AddNumberToObject(entry, "frames_per_second", round(1e5 / median_ms) / 100.0);
    cJSON_AddNumberToObject(entry, "converge_frames", row->result.converge_frames);
    cJSON_AddNumberToObject(entry, "convergence", (double)row->result.convergence);
    cJSON_AddItemToObject(entry, "statistics", bench_result_json(&run, &row->result));
}

// Prints all rows of one test.
static void run_test(struct natus *natus, const struct scene *scene, const struct natus_test *test)
{
    if (test->method == GI_METHOD_NONE) {
        take_row(natus, scene, test, VOXEL_RESOLUTION_AUTO, false);
        return;
    }
    for (int v = VOXEL_RESOLUTION_64; v <= VOXEL_RESOLUTION_256; v++) {
        if (natus->options->voxels != VOXEL_RESOLUTION_AUTO &&
            natus->options->voxels != (uint32_t)v)
            continue;
        take_row(natus, scene, test, (enum voxel_resolution)v, false);
        take_row(natus, scene, test, (enum voxel_resolution)v, true);
    }
}

// Runs the tests of one of the two scenes.
static bool run_scene(struct natus *natus, bool emissive, struct error *out_error)
{
    const struct natus_options *options = natus->options;
    struct scene *scene =
        scene_load(emissive ? options->emissive_scene : options->scene, out_error);
    if (!scene)
        return false;
    give_lights_a_size(scene);
    bool done = renderer_set_scene(natus->renderer, scene, out_error);
    for (size_t i = 0; i < TEST_COUNT && done; i++)
        if (tests[i].emissive == emissive)
            run_test(natus, scene, &tests[i]);
    struct error ignored;
    renderer_set_scene(natus->renderer, NULL, &ignored);
    scene_destroy(&scene);
    return done;
}

// Prints the passes' names in two lines, broken at the first underscore.
static void print_pass_head(FILE *file, const struct frame_statistics *statistics,
                            const bool *shown, bool second_line)
{
    for (uint32_t i = 0; i < statistics->pass_count; i++) {
        if (!shown[i])
            continue;
        const char *name = statistics->passes[i].name;
        const char *underscore = strchr(name, '_');
        char line[32];
        if (!underscore)
            snprintf(line, sizeof(line), "%s", second_line ? name : "");
        else if (second_line)
            snprintf(line, sizeof(line), "%s", underscore + 1);
        else
            snprintf(line, sizeof(line), "%.*s", (int)(underscore - name), name);
        fprintf(file, " %*s", COLUMN_WIDTH, line);
    }
    fputc('\n', file);
}

static void print_row(FILE *file, const struct natus_row *row, const bool *shown)
{
    fprintf(file, "%u %-20s %6s %10s", row->test->number, row->test->name,
            row->voxels == VOXEL_RESOLUTION_AUTO ? "-" : voxel_resolution_names[row->voxels],
            row->voxels == VOXEL_RESOLUTION_AUTO ? "-"
            : row->every_frame                   ? "each frame"
                                                 : "kept");
    if (row->error.message[0]) {
        fprintf(file, "  failed: %s\n", row->error.message);
        return;
    }
    double median_ms = samples_quantile(&row->result.measurement.frame_ms, 0.5);
    fprintf(file, " %8.1f %7.1f %7.1f", median_ms, 1e3 / median_ms,
            (double)bench_memory_bytes(&row->result) / 1048576.0);
    for (uint32_t i = 0; i < row->result.statistics.pass_count; i++) {
        double pass_ms = bench_pass_ms(&row->result, i);
        if (!shown[i])
            continue;
        if (pass_ms > 0.0)
            fprintf(file, " %*.2f", COLUMN_WIDTH, pass_ms);
        else
            fprintf(file, " %*s", COLUMN_WIDTH, "-");
    }
    fputc('\n', file);
}

static void print_table(FILE *file, const struct natus *natus)
{
    bool shown[RENDERER_MAX_PASSES] = {false};
    const struct frame_statistics *statistics = &natus->rows[0].result.statistics;
    for (uint32_t i = 0; i < natus->row_count; i++)
        for (uint32_t p = 0; p < natus->rows[i].result.statistics.pass_count; p++)
            shown[p] = shown[p] || bench_pass_ms(&natus->rows[i].result, p) > 0.0;
    fprintf(file, "%s, %ux%u, high quality, gather mode cache\n\n",
            renderer_get_info(natus->renderer)->gl_renderer, natus->options->size.width,
            natus->options->size.height);
    fprintf(file, "%22s %6s %10s %8s %7s %7s", "", "", "", "frame", "", "memory");
    print_pass_head(file, statistics, shown, false);
    fprintf(file, "%-22s %6s %10s %8s %7s %7s", "test", "voxels", "voxels are", "ms", "fps", "MiB");
    print_pass_head(file, statistics, shown, true);
    for (uint32_t i = 0; i < natus->row_count; i++)
        print_row(file, &natus->rows[i], shown);
}

static bool find_scenes(const char *given, struct natus_options *options, struct error *out_error)
{
    const char *folder = getenv("VOXCAST_SCENES");
    if (given)
        snprintf(options->scene, sizeof(options->scene), "%s", given);
    else if (folder)
        snprintf(options->scene, sizeof(options->scene), "%s/natus-cornell/natus-cornell.glb",
                 folder);
    else
        return error_set(out_error, "--scene FILE is needed, or VOXCAST_SCENES in the environment");
    const char *slash = strrchr(options->scene, '/');
    const char *dot = strrchr(slash ? slash : options->scene, '.');
    int stem = dot ? (int)(dot - options->scene) : (int)strlen(options->scene);
    snprintf(options->emissive_scene, sizeof(options->emissive_scene), "%.*s-emissive%s", stem,
             options->scene, options->scene + stem);
    return true;
}

// False when the command is to end with *out_status.
static bool parse_options(int argc, char **argv, struct natus_options *options, int *out_status)
{
    struct error error = {""};
    struct cli_parser parser = {.command = "bench natus", .usage = usage};
    const char *scene = NULL;
    *options = (struct natus_options){.size = {1024, 768},
                                      .frames = DEFAULT_FRAMES,
                                      .converge_frames = CONVERGE_FRAMES,
                                      .voxels = VOXEL_RESOLUTION_AUTO};
    cli_take_text(&parser, "scene", &scene);
    cli_take_size(&parser, &options->size);
    cli_take_choice(&parser, "voxels", voxel_resolution_names, VOXEL_RESOLUTION_COUNT,
                    &options->voxels);
    cli_take_count(&parser, "frames", 1, MAX_FRAMES, &options->frames);
    cli_take_count(&parser, "converge", 0, MAX_FRAMES, &options->converge_frames);
    cli_take_flag(&parser, "json", &options->json);
    cli_take_gpu(&parser, &options->gpu);
    if (!cli_parse(&parser, argc, argv, out_status))
        return false;
    if (!find_scenes(scene, options, &error))
        *out_status = cli_fail(CLI_EXIT_USAGE, "%s", error.message);
    return *out_status == 0;
}

static int run_all(struct natus *natus)
{
    const struct natus_options *options = natus->options;
    struct error error = {""};
    cJSON *root = cJSON_CreateObject();
    cJSON_AddStringToObject(root, "gl_renderer", renderer_get_info(natus->renderer)->gl_renderer);
    cJSON_AddStringToObject(root, "scene", options->scene);
    cJSON_AddStringToObject(root, "emissive_scene", options->emissive_scene);
    natus->json = cJSON_AddArrayToObject(root, "tests");
    bool done = run_scene(natus, false, &error) && run_scene(natus, true, &error);
    if (done) {
        print_table(options->json ? stderr : stdout, natus);
        if (options->json)
            bench_print_json(root);
    }
    int status = done ? 0 : cli_fail(CLI_EXIT_SCENE, "%s", error.message);
    for (uint32_t i = 0; i < natus->row_count; i++) {
        if (natus->rows[i].error.message[0])
            status = cli_fail(CLI_EXIT_RENDER, "%s", natus->rows[i].error.message);
        bench_result_finish(&natus->rows[i].result);
    }
    cJSON_Delete(root);
    return status;
}

int bench_natus(int argc, char **argv)
{
    struct natus_options options;
    struct error error = {""};
    int status;
    if (!parse_options(argc, argv, &options, &status))
        return status;
    struct natus *natus = calloc(1, sizeof(*natus)); // too large for the stack
    if (!natus)
        return cli_fail(CLI_EXIT_RENDER, "out of memory");
    natus->options = &options;
    natus->renderer = renderer_create(&(struct renderer_params){.gpu = options.gpu}, &error);
    status = natus->renderer ? run_all(natus) : cli_fail(CLI_EXIT_RENDER, "%s", error.message);
    if (natus->renderer)
        renderer_destroy(&natus->renderer);
    free(natus);
    return status;
}
