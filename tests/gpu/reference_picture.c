// Renders a scene by the reference path tracer into float pictures, which voxcast compare compares.
// A tool for people who work on the renderer's light; not a test.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "renderer/scene/scene_load.h"
#include "server/cli.h"
#include "server/cli_options.h"
#include "support_path.h"

static const char usage[] =
    "usage: reference_picture SCENE --out PREFIX [OPTIONS]\n"
    "\n"
    "Writes PREFIX-direct.pfm, -sky.pfm, -indirect.pfm and -total.pfm: linear\n"
    "radiance of a glTF, GLB or OBJ file or builtin:NAME. Direct is emission, background and "
    "light\n"
    "of lamps and emitters reflected once; sky is light of the environment reflected once; "
    "indirect\n"
    "is all light reflected twice or more.\n"
    "  --size WxH        default 160x120\n"
    "  --spp N           paths per pixel, default 64\n"
    "  --bounces N       of indirect light, default unlimited\n"
    "  --eye X,Y,Z --target X,Y,Z [--up X,Y,Z]   default: as voxcast render\n"
    "  --fov-y-deg D     vertical field of view in degrees\n"
    "  --no-environment  leaves the environment out, as --set environment.type=none does\n"
    "  --seed N\n"
    "  --threads N       default 2\n";

struct options {
    const char *source, *prefix;
    bool no_environment;
    struct cli_camera camera;
    struct cli_size size;
    uint32_t samples, bounces, seed, threads;
};

// False when the program is to end with *out_status.
static bool parse_options(struct options *options, int argc, char **argv, int *out_status)
{
    struct cli_parser parser = {.usage = usage, .max_arguments = 1};
    cli_take_text(&parser, "out", &options->prefix);
    cli_take_size(&parser, &options->size);
    cli_take_count(&parser, "spp", 1, 1u << 24, &options->samples);
    cli_take_count(&parser, "bounces", 0, PATH_BOUNCES_UNLIMITED, &options->bounces);
    cli_take_camera(&parser, &options->camera);
    cli_take_count(&parser, "seed", 0, UINT32_MAX, &options->seed);
    cli_take_count(&parser, "threads", 1, 256, &options->threads);
    cli_take_flag(&parser, "no-environment", &options->no_environment);
    if (!cli_parse(&parser, argc, argv, out_status))
        return false;
    if (parser.argument_count == 0 || !options->prefix) {
        fputs(usage, stderr);
        *out_status = CLI_EXIT_USAGE;
        return false;
    }
    options->source = parser.arguments[0];
    return true;
}

static bool write_pfm(const char *prefix, const char *name, const struct path_picture *source,
                      const float *const layers[], int layer_count, struct error *out_error)
{
    char path[4096];
    double sums[3] = {0};
    struct picture picture;
    snprintf(path, sizeof(path), "%s-%s.pfm", prefix, name);
    if (!picture_init(&picture, source->width, source->height))
        return error_set(out_error, "out of memory");
    size_t pixels = picture_pixel_count(&picture);
    for (size_t i = 0; i < 3 * pixels; i++) {
        for (int layer = 0; layer < layer_count; layer++)
            picture.rgb[i] += layers[layer][i / 3 * 4 + i % 3];
        sums[i % 3] += picture.rgb[i];
    }
    bool done = picture_write_pfm(path, &picture, out_error);
    picture_finish(&picture);
    double count = (double)pixels;
    if (done)
        printf("%s mean %.6g %.6g %.6g\n", path, sums[0] / count, sums[1] / count, sums[2] / count);
    return done;
}

static bool render(const struct options *options)
{
    struct error error = {""};
    struct scene *scene = scene_load(options->source, &error);
    struct path_params path = {.scene = scene,
                               .width = options->size.width,
                               .height = options->size.height,
                               .samples = options->samples,
                               .bounces = options->bounces,
                               .seed = options->seed,
                               .threads = options->threads};
    if (!scene ||
        !cli_camera_choose(&options->camera, scene, (float)path.width / (float)path.height,
                           &path.camera, &error)) {
        fprintf(stderr, "reference_picture: %s\n", error.message);
        scene_destroy(&scene);
        return false;
    }
    if (options->no_environment)
        scene->environment.type = SCENE_ENVIRONMENT_NONE;
    struct path_picture picture = {0};
    bool done = path_trace(&path, &picture);
    if (!done)
        error_set(&error, "out of memory");
    const float *const layers[3] = {picture.direct, picture.sky, picture.indirect};
    done = done && write_pfm(options->prefix, "direct", &picture, layers, 1, &error) &&
           write_pfm(options->prefix, "sky", &picture, layers + 1, 1, &error) &&
           write_pfm(options->prefix, "indirect", &picture, layers + 2, 1, &error) &&
           write_pfm(options->prefix, "total", &picture, layers, 3, &error);
    if (!done)
        fprintf(stderr, "reference_picture: %s\n", error.message);
    path_picture_finish(&picture);
    scene_destroy(&scene);
    return done;
}

int main(int argc, char **argv)
{
    log_set_level(LOG_ERROR);
    struct options options = {.size = {160, 120}, .samples = 64, .bounces = PATH_BOUNCES_UNLIMITED};
    int status;
    if (!parse_options(&options, argc, argv, &status))
        return status;
    return render(&options) ? 0 : 1;
}
