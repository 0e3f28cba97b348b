// voxcast render: one scene to one picture.
#include <cjson/cJSON.h>
#include <getopt.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/cli.h"
#include "server/document.h"

#define MAX_SETS   256
#define MAX_FRAMES 100000

static const char usage[] =
    "usage: voxcast render SCENE|builtin:NAME --out FILE [OPTIONS]\n"
    "\n"
    "  --out FILE           .pfm: linear Rec.709 radiance in cd/m^2 before exposure and tone\n"
    "                       mapping; .png or .jpg: the displayed picture\n"
    "  --camera NAME|INDEX  a camera of the scene (default: the first, or one that frames it)\n"
    "  --eye X,Y,Z --target X,Y,Z [--up X,Y,Z]   a camera of your own, in metres\n"
    "  --fov-y-deg D        vertical field of view in degrees, 0.1 to 179\n"
    "  --size WxH           1x1 to 3840x2160 (default 1280x720)\n"
    "  --gi METHOD          method of global illumination: none, clipmap or grid\n"
    "  --preset NAME        draft, interactive, high or final (default: final; with several\n"
    "                       frames: interactive)\n"
    "  --view VIEW          final, direct, albedo, normal, roughness, metallic, emission, depth,\n"
    "                       ids, lights_per_tile, shadow_cascades, voxel_opacity, voxel_albedo,\n"
    "                       voxel_normal, voxel_radiance, voxel_irradiance, indirect_diffuse,\n"
    "                       indirect_specular, ambient_occlusion, cache_age or tile_classes;\n"
    "                       see also --set debug_level=N and debug_face=+x\n"
    "  --set KEY=VALUE      a parameter, such as lights.0.intensity=20 or exposure_ev=1; may be\n"
    "                       given many times\n"
    "  --frames N           render exactly N frames and measure them (default: as many as the\n"
    "                       picture needs to converge)\n"
    "  --move-eye X,Y,Z     with --frames: displacement of eye and target per frame, in metres\n"
    "  --converge-first     with --frames: let the first picture converge before measuring\n"
    "  --stats FILE         write statistics as JSON\n"
    "  --gpu WHICH          auto, software or a device index (default auto)\n";

struct render_options {
    const char *scene;
    const char *out;
    const char *stats;
    const char *camera;
    const char *gpu;
    const char *preset;
    bool has_eye, has_target, has_up, has_fov, has_move, converge_first;
    float eye[3], target[3], up[3], move[3];
    float fov_y_rad;
    uint32_t frames; // 0: until the picture has converged
    uint32_t set_count;
    const char *sets[MAX_SETS];
    uint32_t width, height;
    const char *gi, *view;
};

static bool parse_vector(const char *text, float out_vector[3])
{
    float v[3];
    char extra;
    if (sscanf(text, "%f,%f,%f%c", &v[0], &v[1], &v[2], &extra) != 3)
        return false;
    for (int i = 0; i < 3; i++)
        if (!isfinite(v[i]))
            return false;
    memcpy(out_vector, v, sizeof(v));
    return true;
}

static bool parse_size(const char *text, struct render_options *options)
{
    unsigned width, height;
    char extra;
    if (sscanf(text, "%5ux%5u%c", &width, &height, &extra) != 2 || width < VIEW_MIN_EDGE ||
        width > VIEW_MAX_WIDTH || height < VIEW_MIN_EDGE || height > VIEW_MAX_HEIGHT)
        return false;
    options->width = width;
    options->height = height;
    return true;
}

static bool parse_number(const char *text, double low, double high, double *out_number)
{
    char *end;
    double number = strtod(text, &end);
    if (end == text || *end != '\0' || !(number >= low && number <= high))
        return false;
    *out_number = number;
    return true;
}

// Takes one option; false with a message.
static bool take_option(struct render_options *options, int option, const char *value,
                        struct error *out_error)
{
    double number;
    switch (option) {
    case 'o':
        options->out = value;
        return true;
    case 'c':
        options->camera = value;
        return true;
    case 'e':
        options->has_eye = true;
        return parse_vector(value, options->eye) ||
               error_set(out_error, "--eye is \"%s\"; three finite numbers X,Y,Z are needed",
                         value);
    case 't':
        options->has_target = true;
        return parse_vector(value, options->target) ||
               error_set(out_error, "--target is \"%s\"; three finite numbers X,Y,Z are needed",
                         value);
    case 'u':
        options->has_up = true;
        return parse_vector(value, options->up) ||
               error_set(out_error, "--up is \"%s\"; three finite numbers X,Y,Z are needed", value);
    case 'm':
        options->has_move = true;
        return parse_vector(value, options->move) ||
               error_set(out_error, "--move-eye is \"%s\"; three finite numbers X,Y,Z are needed",
                         value);
    case 'f':
        if (!parse_number(value, 0.1, 179.0, &number))
            return error_set(out_error, "--fov-y-deg is \"%s\"; allowed: 0.1 to 179", value);
        options->has_fov = true;
        options->fov_y_rad = (float)(number * M_PI / 180.0);
        return true;
    case 's':
        return parse_size(value, options) ||
               error_set(out_error, "--size is \"%s\"; allowed: WxH from 1x1 to %ux%u", value,
                         VIEW_MAX_WIDTH, VIEW_MAX_HEIGHT);
    case 'n':
        if (!parse_number(value, 1, MAX_FRAMES, &number) || number != floor(number))
            return error_set(out_error, "--frames is \"%s\"; allowed: 1 to %d", value, MAX_FRAMES);
        options->frames = (uint32_t)number;
        return true;
    case 'k':
        options->converge_first = true;
        return true;
    case 'S':
        if (options->set_count == MAX_SETS)
            return error_set(out_error, "--set is given more than %d times", MAX_SETS);
        options->sets[options->set_count++] = value;
        return true;
    case 'g':
        options->gi = value;
        return true;
    case 'p':
        options->preset = value;
        return true;
    case 'v':
        options->view = value;
        return true;
    case 'j':
        options->stats = value;
        return true;
    case 'G':
        options->gpu = value;
        return true;
    default:
        return error_set(out_error, "unknown or incomplete option; see voxcast render --help");
    }
}

static const struct option long_options[] = {
    {"out", required_argument, NULL, 'o'},      {"camera", required_argument, NULL, 'c'},
    {"eye", required_argument, NULL, 'e'},      {"target", required_argument, NULL, 't'},
    {"up", required_argument, NULL, 'u'},       {"fov-y-deg", required_argument, NULL, 'f'},
    {"size", required_argument, NULL, 's'},     {"gi", required_argument, NULL, 'g'},
    {"preset", required_argument, NULL, 'p'},   {"view", required_argument, NULL, 'v'},
    {"set", required_argument, NULL, 'S'},      {"frames", required_argument, NULL, 'n'},
    {"move-eye", required_argument, NULL, 'm'}, {"converge-first", no_argument, NULL, 'k'},
    {"stats", required_argument, NULL, 'j'},    {"gpu", required_argument, NULL, 'G'},
    {"help", no_argument, NULL, 'h'},           {NULL, 0, NULL, 0},
};

static bool check_options(const struct render_options *options, struct error *out_error)
{
    enum frame_output output;
    if (!options->scene)
        return error_set(out_error, "no scene given; see voxcast render --help");
    if (!options->out)
        return error_set(out_error, "no --out FILE given");
    if (!cli_output_of(options->out, &output))
        return error_set(out_error, "--out is \"%s\"; allowed extensions: .pfm, .png, .jpg",
                         options->out);
    if (options->frames == 0 && (options->has_move || options->converge_first))
        return error_set(out_error, "--move-eye and --converge-first need --frames");
    if (options->has_eye != options->has_target)
        return error_set(out_error, "--eye and --target are needed together");
    if (options->camera && options->has_eye)
        return error_set(out_error, "--camera and --eye exclude each other");
    return true;
}

// Options of the command line, or false with a message; `out_help` if help was asked for.
static bool parse_options(int argc, char **argv, struct render_options *options, bool *out_help,
                          struct error *out_error)
{
    *options = (struct render_options){
        .gpu = "auto", .width = 1280, .height = 720, .up = {0.0f, 1.0f, 0.0f}};
    *out_help = false;
    opterr = 0;
    optind = 1;
    int option;
    while ((option = getopt_long(argc, argv, "", long_options, NULL)) != -1) {
        if (option == 'h') {
            *out_help = true;
            return true;
        }
        if (option == '?')
            return error_set(out_error,
                             "unknown or incomplete option \"%s\"; see voxcast render "
                             "--help",
                             argv[optind - 1]);
        if (!take_option(options, option, optarg, out_error))
            return false;
    }
    if (optind < argc)
        options->scene = argv[optind++];
    if (optind < argc)
        return error_set(out_error, "unexpected argument \"%s\"", argv[optind]);
    return check_options(options, out_error);
}

static bool choose_camera(const struct render_options *options, const struct scene *scene,
                          struct view_camera *out_camera, struct error *out_error)
{
    cli_default_camera(scene, (float)options->width / (float)options->height, out_camera);
    if (options->has_eye) {
        memcpy(out_camera->eye, options->eye, sizeof(options->eye));
        memcpy(out_camera->target, options->target, sizeof(options->target));
        memcpy(out_camera->up, options->up, sizeof(options->up));
    }
    if (options->camera) {
        uint32_t found = SCENE_NONE;
        char *end;
        unsigned long index = strtoul(options->camera, &end, 10);
        if (*options->camera && !*end && index < scene->camera_count)
            found = (uint32_t)index;
        for (uint32_t i = 0; i < scene->camera_count && found == SCENE_NONE; i++)
            if (strcmp(scene->cameras[i].name, options->camera) == 0)
                found = i;
        if (found == SCENE_NONE)
            return error_set(out_error, "there is no camera \"%s\"; the scene has %u cameras",
                             options->camera, scene->camera_count);
        scene_get_camera_placement(scene, found, out_camera->eye, out_camera->target,
                                   out_camera->up);
        out_camera->fov_y_rad = scene->cameras[found].fov_y_rad;
    }
    if (options->has_fov)
        out_camera->fov_y_rad = options->fov_y_rad;
    return true;
}

// Applies --gi, --preset, --view and every --set.
static bool apply_settings(const struct render_options *options, struct scene *scene,
                           struct render_settings *settings, struct view_options *view,
                           struct error *out_error)
{
    const char *preset = options->preset;
    if (!preset)
        preset = options->frames > 1 ? "interactive" : "final";
    const char *const named[][2] = {{"settings.gi_method", options->gi},
                                    {"view.quality", preset},
                                    {"view.debug_view", options->view}};
    for (int i = 0; i < 3; i++)
        if (named[i][1] &&
            !document_set_text(scene, settings, view, named[i][0], named[i][1], out_error))
            return false;
    for (uint32_t i = 0; i < options->set_count; i++) {
        char key[256];
        const char *equals = strchr(options->sets[i], '=');
        if (!equals || (size_t)(equals - options->sets[i]) >= sizeof(key))
            return error_set(out_error, "--set is \"%.200s\"; KEY=VALUE is needed",
                             options->sets[i]);
        snprintf(key, sizeof(key), "%.*s", (int)(equals - options->sets[i]), options->sets[i]);
        if (!document_set_text(scene, settings, view, key, equals + 1, out_error))
            return false;
    }
    return true;
}

static void move_camera(struct view_camera *camera, const float move[3])
{
    for (int axis = 0; axis < 3; axis++) {
        camera->eye[axis] += move[axis];
        camera->target[axis] += move[axis];
    }
}

static bool write_json(const char *path, struct cJSON *json, struct error *out_error)
{
    char *text = cJSON_Print(json);
    FILE *file = text ? fopen(path, "wb") : NULL;
    bool done = file && fputs(text, file) >= 0 && fputc('\n', file) != EOF;
    if (file)
        done = fclose(file) == 0 && done;
    cJSON_free(text);
    return done || error_set(out_error, "cannot write \"%s\"", path);
}

// What the frames of one command share.
struct render_job {
    const struct render_options *options;
    struct renderer *renderer;
    struct view *view;
    const struct scene *scene;
    struct frame_params *params;
    struct cli_measurement measurement;
    float convergence; // of the newest frame
    bool converged;
};

// Frames until the picture has converged; measured if `measurement` is there, written if `path` is.
static int render_still(struct render_job *job, struct cli_measurement *measurement,
                        const char *path)
{
    struct error error = {""};
    struct cli_still still = {.renderer = job->renderer,
                              .view = job->view,
                              .params = job->params,
                              .max_frames = CLI_MAX_STILL_FRAMES,
                              .measurement = measurement};
    if (!cli_render_still(&still, &error))
        return cli_fail(CLI_EXIT_RENDER, "%s", error.message);
    job->convergence = still.pixels.convergence;
    job->converged = still.converged;
    if (!still.converged)
        fprintf(stderr, "voxcast: warning: not converged after %u frames, but %.0f %% on the way\n",
                still.frame_count, 100.0 * (double)still.pixels.convergence);
    int status = 0;
    if (path && !cli_write_picture(path, &still.pixels, &error))
        status = cli_fail(CLI_EXIT_OUTPUT, "%s", error.message);
    renderer_view_release(job->renderer, job->view);
    return status;
}

// Renders one frame, measures it, and writes it if `path` is there.
static int render_one(struct render_job *job, bool measured, const char *path)
{
    struct error error = {""};
    struct frame_pixels pixels;
    bool drawn = job->options->has_move
                     ? cli_render_next_frame(job->renderer, job->view, job->params, &pixels, &error)
                     : cli_render_frame(job->renderer, job->view, job->params, &pixels, &error);
    if (!drawn)
        return cli_fail(CLI_EXIT_RENDER, "%s", error.message);
    int status = 0;
    struct frame_statistics statistics;
    renderer_view_get_statistics(job->renderer, job->view, &statistics);
    job->convergence = pixels.convergence;
    if (measured && !cli_measurement_add(&job->measurement, &statistics))
        status = cli_fail(CLI_EXIT_RENDER, "out of memory");
    if (status == 0 && path && !cli_write_picture(path, &pixels, &error))
        status = cli_fail(CLI_EXIT_OUTPUT, "%s", error.message);
    renderer_view_release(job->renderer, job->view);
    return status;
}

// Exactly as many frames as were asked for; the newest is written.
static int render_count(struct render_job *job)
{
    const struct render_options *options = job->options;
    // One frame more, not measured, so that compiling shaders is not taken for rendering.
    uint32_t warm_up = options->frames > 1 && !options->converge_first ? 1 : 0;
    uint32_t count = options->frames + warm_up;
    int status = 0;
    if (options->converge_first) {
        status = render_still(job, NULL, NULL);
        move_camera(&job->params->camera, options->move);
    }
    for (uint32_t i = 0; i < count && status == 0; i++) {
        status = render_one(job, i >= warm_up, i + 1 == count ? options->out : NULL);
        move_camera(&job->params->camera, options->move);
    }
    return status;
}

static int write_statistics(const struct render_job *job)
{
    struct error error = {""};
    struct frame_statistics statistics;
    renderer_view_get_statistics(job->renderer, job->view, &statistics);
    struct cJSON *json =
        cli_statistics_json(&job->measurement, &statistics, renderer_get_info(job->renderer),
                            job->scene, job->params->width, job->params->height);
    cJSON_AddNumberToObject(json, "convergence", (double)job->convergence);
    if (job->options->frames == 0)
        cJSON_AddBoolToObject(json, "converged", job->converged);
    bool done = write_json(job->options->stats, json, &error);
    cJSON_Delete(json);
    return done ? 0 : cli_fail(CLI_EXIT_OUTPUT, "%s", error.message);
}

static int render_frames(const struct render_options *options, struct renderer *renderer,
                         const struct scene *scene, struct frame_params *params)
{
    struct render_job job = {.options = options,
                             .renderer = renderer,
                             .view = renderer_view_create(renderer),
                             .scene = scene,
                             .params = params};
    if (!job.view)
        return cli_fail(CLI_EXIT_RENDER, "out of memory");
    int status = options->frames > 0 ? render_count(&job)
                                     : render_still(&job, &job.measurement, options->out);
    if (status == 0 && options->stats)
        status = write_statistics(&job);
    cli_measurement_finish(&job.measurement);
    renderer_view_destroy(renderer, &job.view);
    return status;
}

int cli_render(int argc, char **argv)
{
    struct render_options options;
    struct error error = {""};
    bool help;
    if (!parse_options(argc, argv, &options, &help, &error))
        return cli_fail(CLI_EXIT_USAGE, "%s", error.message);
    if (help) {
        fputs(usage, stdout);
        return 0;
    }
    struct scene *scene = scene_load(options.scene, &error);
    if (!scene)
        return cli_fail(CLI_EXIT_SCENE, "%s", error.message);
    for (uint32_t i = 0; i < scene->warning_count; i++)
        fprintf(stderr, "voxcast: warning: %s\n", scene->warnings[i]);
    struct frame_params params = {0};
    struct view_options view;
    struct renderer *renderer = NULL;
    int status = 0;
    render_settings_init(&params.settings);
    view_options_init(&view);
    view.width = options.width;
    view.height = options.height;
    if (!choose_camera(&options, scene, &view.camera, &error) ||
        !apply_settings(&options, scene, &params.settings, &view, &error)) {
        status = cli_fail(CLI_EXIT_USAGE, "%s", error.message);
        goto done;
    }
    params.width = view.width;
    params.height = view.height;
    params.camera = view.camera;
    params.quality = view.quality;
    params.debug_view = view.debug_view;
    params.debug_level = view.debug_level;
    params.debug_face = view.debug_face;
    cli_output_of(options.out, &params.output);
    renderer = renderer_create(&(struct renderer_params){.gpu = options.gpu}, &error);
    if (!renderer || !renderer_set_scene(renderer, scene, &error)) {
        status = cli_fail(CLI_EXIT_RENDER, "%s", error.message);
        goto done;
    }
    status = render_frames(&options, renderer, scene, &params);
    if (status == 0 && renderer_gl_error_count(renderer) > 0)
        status = cli_fail(CLI_EXIT_RENDER, "the GL driver reported %llu errors",
                          (unsigned long long)renderer_gl_error_count(renderer));
done:
    if (renderer)
        renderer_destroy(&renderer);
    scene_destroy(&scene);
    return status;
}
