// voxcast render: renders one scene to one image.
#include <cjson/cJSON.h>
#include <stdio.h>

#include "server/accuracy/converged_frames.h"
#include "server/accuracy/measurement.h"
#include "server/accuracy/picture_file.h"
#include "server/tool/cli.h"
#include "server/tool/trace_reference.h"

#define MAX_FRAMES 100000

static const char usage[] =
    "usage: voxcast render SCENE|builtin:NAME --out FILE [OPTIONS]\n"
    "\n"
    "  --out FILE           .pfm: linear Rec.709 radiance in cd/m^2 before exposure and tone\n"
    "                       mapping; .png or .jpg: the displayed image\n"
    "  --camera NAME|INDEX  a camera of the scene (default: the first, or one that frames it)\n"
    "  --eye X,Y,Z --target X,Y,Z [--up X,Y,Z]   a camera of your own, in metres\n"
    "  --fov-y-deg D        vertical field of view in degrees, 0.1 to 179\n"
    "  --environment FILE   .hdr or .exr, an equirectangular image that lights the scene\n"
    "  --size WxH           1x1 to 4096x2160 (default 1280x720)\n"
    "  --gi METHOD          method of global illumination: @gi\n"
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
    "                       image needs to converge)\n"
    "  --move-eye X,Y,Z     with --frames: displacement of eye and target per frame, in metres\n"
    "  --converge-first     with --frames: let the first image converge before measuring\n"
    "  --stats FILE         write statistics as JSON\n"
    "  --gpu WHICH          auto, software or a device index (default auto)\n"
    "  --scene-cache-mib N  limit of what is kept on disk to open scenes faster (default 2048); 0\n"
    "                       keeps and uses nothing\n"
    "\n"
    "With --gi reference, the reference image by a path tracer on the CPU:\n"
    "  --spp N              samples per pixel (default 64, or as many as time and noise allow)\n"
    "  --time S             at most so many seconds\n"
    "  --noise X            until the estimated standard error of pixels is below this share of\n"
    "                       the mean luminance\n"
    "  --bounces N          of indirect light, 0 or more (default: the parameter's, unlimited)\n"
    "  --light WHICH        all, direct (reflected once at most) or indirect\n"
    "  --bounce N           light of one bounce alone: 1 is reflected twice, up to 7\n"
    "  --estimator NAME     how light is found: by aiming at lights, by following surfaces, or\n"
    "                       both (default)\n"
    "  --seed N             the same seed gives the same image\n"
    "  --threads N          default: as many as there are processors\n";

struct render_options {
    struct cli_shot_options shot;
    struct cli_reference_options reference;
    const char *out, *stats;
    struct cli_vector move;
    bool converge_first;
    uint32_t frames; // 0: until the image has converged
};

static bool check_options(const struct cli_parser *parser, struct render_options *options,
                          struct error *out_error)
{
    enum frame_output output;
    if (parser->argument_count == 0)
        return error_set(out_error, "no scene given; see voxcast render --help");
    options->shot.source = parser->arguments[0];
    if (!options->out)
        return error_set(out_error, "no --out FILE given");
    if (!picture_file_output(options->out, &output))
        return error_set(out_error, "--out is \"%s\"; allowed extensions: .pfm, .png, .jpg",
                         options->out);
    if (options->frames == 0 && (options->move.given || options->converge_first))
        return error_set(out_error, "--move-eye and --converge-first need --frames");
    return true;
}

// False when the command is to end with *out_status.
static bool parse_options(int argc, char **argv, struct render_options *options, int *out_status)
{
    struct error error = {""};
    struct cli_parser parser = {.command = "render", .usage = usage, .max_arguments = 1};
    *options = (struct render_options){.shot.size = {1280, 720}};
    cli_take_shot(&parser, &options->shot);
    cli_take_reference(&parser, &options->reference);
    cli_take_text(&parser, "out", &options->out);
    cli_take_text(&parser, "stats", &options->stats);
    cli_take_count(&parser, "frames", 1, MAX_FRAMES, &options->frames);
    cli_take_vector(&parser, "move-eye", &options->move);
    cli_take_flag(&parser, "converge-first", &options->converge_first);
    if (!cli_parse(&parser, argc, argv, out_status))
        return false;
    if (!check_options(&parser, options, &error))
        *out_status = cli_fail(CLI_EXIT_USAGE, "%s", error.message);
    return *out_status == 0;
}

static void move_camera(struct view_camera *camera, const float move[3])
{
    for (int axis = 0; axis < 3; axis++) {
        camera->eye[axis] += move[axis];
        camera->target[axis] += move[axis];
    }
}

// What the frames of one command share.
struct render_job {
    const struct render_options *options;
    struct renderer *renderer;
    struct view *view;
    const struct scene *scene;
    struct frame_params *params;
    struct measurement measurement;
    float convergence; // of the newest frame
    bool converged;
};

// Draws frames until the image has converged. Adds them to `measurement` and writes the image to
// `path`, if these are not NULL.
static int render_converged(struct render_job *job, struct measurement *measurement,
                            const char *path)
{
    struct error error = {""};
    struct converged_frames render = {.renderer = job->renderer,
                                      .view = job->view,
                                      .params = job->params,
                                      .max_frames = MAX_CONVERGING_FRAMES,
                                      .measurement = measurement};
    if (!frames_render_converged(&render, &error))
        return cli_fail(CLI_EXIT_RENDER, "%s", error.message);
    job->convergence = render.pixels.convergence;
    job->converged = render.converged;
    if (!render.converged)
        fprintf(stderr, "voxcast: warning: not converged after %u frames, but %.0f %% on the way\n",
                render.frame_count, 100.0 * (double)render.pixels.convergence);
    int status = 0;
    if (path && !picture_file_write(path, &render.pixels, &error))
        status = cli_fail(CLI_EXIT_OUTPUT, "%s", error.message);
    renderer_view_release(job->renderer, job->view);
    return status;
}

// Renders one frame, adds it to `measurement`, and writes it if `path` is not NULL.
static int render_one(struct render_job *job, bool measured, const char *path)
{
    struct error error = {""};
    struct frame_pixels pixels;
    bool drawn = job->options->move.given
                     ? frames_render_next(job->renderer, job->view, job->params, &pixels, &error)
                     : frames_render(job->renderer, job->view, job->params, &pixels, &error);
    if (!drawn)
        return cli_fail(CLI_EXIT_RENDER, "%s", error.message);
    int status = 0;
    struct frame_statistics statistics;
    renderer_view_get_statistics(job->renderer, job->view, &statistics);
    job->convergence = pixels.convergence;
    if (measured && !measurement_add(&job->measurement, &statistics))
        status = cli_fail(CLI_EXIT_RENDER, "out of memory");
    if (status == 0 && path && !picture_file_write(path, &pixels, &error))
        status = cli_fail(CLI_EXIT_OUTPUT, "%s", error.message);
    renderer_view_release(job->renderer, job->view);
    return status;
}

// Renders exactly as many frames as were asked for and writes the newest.
static int render_count(struct render_job *job)
{
    const struct render_options *options = job->options;
    // One frame more, not measured, so that the times do not include compiling of shaders.
    uint32_t warm_up = options->frames > 1 && !options->converge_first ? 1 : 0;
    uint32_t count = options->frames + warm_up;
    int status = 0;
    if (options->converge_first) {
        status = render_converged(job, NULL, NULL);
        move_camera(&job->params->camera, options->move.xyz);
    }
    for (uint32_t i = 0; i < count && status == 0; i++) {
        status = render_one(job, i >= warm_up, i + 1 == count ? options->out : NULL);
        move_camera(&job->params->camera, options->move.xyz);
    }
    return status;
}

static int write_statistics(const struct render_job *job)
{
    struct error error = {""};
    struct frame_statistics statistics;
    renderer_view_get_statistics(job->renderer, job->view, &statistics);
    struct cJSON *json =
        measurement_json(&job->measurement, &statistics, renderer_get_info(job->renderer),
                         job->scene, job->params->width, job->params->height);
    cJSON_AddNumberToObject(json, "convergence", (double)job->convergence);
    const struct scene_cache_statistics cache = scene_cache_get_statistics();
    struct cJSON *object = cJSON_AddObjectToObject(json, "scene_cache");
    cJSON_AddNumberToObject(object, "hits", (double)cache.hits);
    cJSON_AddNumberToObject(object, "misses", (double)cache.misses);
    cJSON_AddNumberToObject(object, "invalid", (double)cache.invalid);
    cJSON_AddNumberToObject(object, "written_bytes", (double)cache.written_bytes);
    const struct process_memory memory = process_memory_read();
    struct cJSON *process = cJSON_AddObjectToObject(json, "process");
    cJSON_AddNumberToObject(process, "rss_bytes", (double)memory.rss_bytes);
    cJSON_AddNumberToObject(process, "peak_bytes", (double)memory.peak_bytes);
    if (job->options->frames == 0)
        cJSON_AddBoolToObject(json, "converged", job->converged);
    bool done = cli_write_json(job->options->stats, json, &error);
    cJSON_Delete(json);
    return done ? 0 : cli_fail(CLI_EXIT_OUTPUT, "%s", error.message);
}

static int render_frames(const struct render_options *options, struct shot *shot)
{
    struct render_job job = {.options = options,
                             .renderer = shot->renderer,
                             .view = renderer_view_create(shot->renderer),
                             .scene = shot->scene,
                             .params = &shot->params};
    if (!job.view)
        return cli_fail(CLI_EXIT_RENDER, "out of memory");
    int status = options->frames > 0 ? render_count(&job)
                                     : render_converged(&job, &job.measurement, options->out);
    if (status == 0 && options->stats)
        status = write_statistics(&job);
    measurement_finish(&job.measurement);
    renderer_view_destroy(shot->renderer, &job.view);
    return status;
}

int cli_render(int argc, char **argv)
{
    struct render_options options;
    struct shot shot;
    int status;
    if (!parse_options(argc, argv, &options, &status))
        return status;
    status = cli_shot_load(&options.shot, options.frames > 1 ? QUALITY_INTERACTIVE : QUALITY_FINAL,
                           &shot);
    if (status == 0 && shot.params.settings.gi_method == GI_METHOD_REFERENCE) {
        status = cli_render_reference(&options.reference, &shot, options.out, options.stats);
        shot_close(&shot);
        return status;
    }
    if (status == 0)
        status = cli_shot_start(&options.shot, &shot);
    if (status != 0)
        return status;
    picture_file_output(options.out, &shot.params.output);
    status = render_frames(&options, &shot);
    if (status == 0 && renderer_gl_error_count(shot.renderer) > 0)
        status = cli_fail(CLI_EXIT_RENDER, "the GL driver reported %llu errors",
                          (unsigned long long)renderer_gl_error_count(shot.renderer));
    shot_close(&shot);
    return status;
}
