// voxcast bench: moving-camera frames of scenes, median and p95 per pass as JSON on stdout.
#include <cjson/cJSON.h>
#include <getopt.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "server/cli.h"

#define DEFAULT_FRAMES 60
#define WARM_UP_FRAMES 3
#define ORBIT_STEP_RAD 0.01f

static const char usage[] =
    "usage: voxcast bench [SCENE|builtin:NAME]... [OPTIONS]\n"
    "\n"
    "Measures frames of a camera that sways around its target, for each scene (default: all\n"
    "built-in ones), and prints JSON.\n"
    "\n"
    "  --frames N      frames measured per scene, 1 to 10000 (default 60)\n"
    "  --preset NAME   draft, interactive, high or final (default interactive)\n"
    "  --gpu WHICH     auto, software or a device index (default auto)\n";

struct bench_options {
    const char *gpu;
    uint32_t frames;
    enum quality quality;
};

static double now_ms(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec * 1e3 + (double)now.tv_nsec / 1e6;
}

// Turns the eye about the vertical through the target.
static void sway_camera(const struct view_camera *from, uint32_t frame, struct view_camera *to)
{
    *to = *from;
    float angle = 0.3f * sinf((float)frame * ORBIT_STEP_RAD * 3.0f);
    float x = from->eye[0] - from->target[0], z = from->eye[2] - from->target[2];
    to->eye[0] = from->target[0] + cosf(angle) * x + sinf(angle) * z;
    to->eye[2] = from->target[2] - sinf(angle) * x + cosf(angle) * z;
}

static bool measure(struct renderer *renderer, const struct scene *scene,
                    const struct bench_options *options, struct cJSON *entry,
                    struct error *out_error)
{
    struct frame_params params = {
        .width = 640, .height = 360, .quality = options->quality, .output = FRAME_OUTPUT_YCBCR};
    render_settings_init(&params.settings);
    struct view_camera start;
    cli_default_camera(scene, 640.0f / 360.0f, &start);
    struct view *view = renderer_view_create(renderer);
    struct cli_measurement measurement = {0};
    struct frame_statistics statistics = {0};
    bool done = view != NULL;
    for (uint32_t i = 0; i < options->frames + WARM_UP_FRAMES && done; i++) {
        struct frame_pixels pixels;
        sway_camera(&start, i, &params.camera);
        done = cli_render_frame(renderer, view, &params, &pixels, out_error);
        if (!done)
            break;
        renderer_view_get_statistics(renderer, view, &statistics);
        renderer_view_release(renderer, view);
        if (i >= WARM_UP_FRAMES)
            done = cli_measurement_add(&measurement, &statistics);
    }
    if (done)
        cJSON_AddItemToObject(entry, "statistics",
                              cli_statistics_json(&measurement, &statistics,
                                                  renderer_get_info(renderer), scene, params.width,
                                                  params.height));
    cli_measurement_finish(&measurement);
    renderer_view_destroy(renderer, &view);
    return done;
}

static bool bench_scene(struct renderer *renderer, const char *source,
                        const struct bench_options *options, struct cJSON *list,
                        struct error *out_error)
{
    double started_ms = now_ms();
    struct scene *scene = scene_load(source, out_error);
    if (!scene)
        return false;
    double loaded_ms = now_ms();
    struct cJSON *entry = cJSON_CreateObject();
    cJSON_AddItemToArray(list, entry);
    cJSON_AddStringToObject(entry, "name", source);
    bool done = renderer_set_scene(renderer, scene, out_error);
    cJSON_AddNumberToObject(entry, "load_ms", round(loaded_ms - started_ms));
    cJSON_AddNumberToObject(entry, "upload_ms", round(now_ms() - loaded_ms));
    done = done && measure(renderer, scene, options, entry, out_error);
    struct error ignored;
    renderer_set_scene(renderer, NULL, &ignored);
    scene_destroy(&scene);
    return done;
}

static bool parse_quality(const char *text, enum quality *out_quality)
{
    for (int i = 0; i < QUALITY_COUNT; i++)
        if (strcmp(quality_names[i], text) == 0) {
            *out_quality = (enum quality)i;
            return true;
        }
    return false;
}

int cli_bench(int argc, char **argv)
{
    static const struct option long_options[] = {{"frames", required_argument, NULL, 'n'},
                                                 {"preset", required_argument, NULL, 'p'},
                                                 {"gpu", required_argument, NULL, 'G'},
                                                 {"help", no_argument, NULL, 'h'},
                                                 {NULL, 0, NULL, 0}};
    struct bench_options options = {
        .gpu = "auto", .frames = DEFAULT_FRAMES, .quality = QUALITY_INTERACTIVE};
    opterr = 0;
    optind = 1;
    int option;
    while ((option = getopt_long(argc, argv, "", long_options, NULL)) != -1) {
        switch (option) {
        case 'h':
            fputs(usage, stdout);
            return 0;
        case 'n':
            options.frames = (uint32_t)strtoul(optarg, NULL, 10);
            if (options.frames < 1 || options.frames > 10000)
                return cli_fail(CLI_EXIT_USAGE, "--frames is \"%s\"; allowed: 1 to 10000", optarg);
            break;
        case 'p':
            if (!parse_quality(optarg, &options.quality))
                return cli_fail(CLI_EXIT_USAGE,
                                "--preset is \"%s\"; allowed: draft, interactive, "
                                "high, final",
                                optarg);
            break;
        case 'G':
            options.gpu = optarg;
            break;
        default:
            return cli_fail(CLI_EXIT_USAGE, "unknown or incomplete option \"%s\"",
                            argv[optind - 1]);
        }
    }
    struct error error = {""};
    struct renderer *renderer =
        renderer_create(&(struct renderer_params){.gpu = options.gpu}, &error);
    if (!renderer)
        return cli_fail(CLI_EXIT_RENDER, "%s", error.message);
    struct cJSON *root = cJSON_CreateObject();
    struct cJSON *list = cJSON_AddArrayToObject(root, "scenes");
    int status = 0;
    for (int i = optind; i < argc && status == 0; i++)
        if (!bench_scene(renderer, argv[i], &options, list, &error))
            status = cli_fail(CLI_EXIT_SCENE, "%s", error.message);
    for (uint32_t i = 0; optind == argc && status == 0 && scene_builtin_name(i); i++) {
        char source[128];
        snprintf(source, sizeof(source), "builtin:%s", scene_builtin_name(i));
        if (!bench_scene(renderer, source, &options, list, &error))
            status = cli_fail(CLI_EXIT_SCENE, "%s", error.message);
    }
    renderer_destroy(&renderer);
    char *text = status == 0 ? cJSON_Print(root) : NULL;
    if (text)
        puts(text);
    cJSON_free(text);
    cJSON_Delete(root);
    return status;
}
