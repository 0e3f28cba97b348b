// Renders a scene by the reference path tracer into float pictures, and compares float pictures.
// A tool for people who work on the renderer's light; not a test.
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "renderer/scene/scene_load.h"
#include "server/cli.h"
#include "server/cli_options.h"
#include "support_path_tracer.h"

static const char usage[] =
    "usage: reference_picture SCENE --out PREFIX [OPTIONS]\n"
    "       reference_picture --compare A.pfm B.pfm [--minus C.pfm]\n"
    "\n"
    "The first form writes PREFIX-direct.pfm, -sky.pfm, -indirect.pfm and -total.pfm: linear\n"
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
    "  --threads N       default 2\n"
    "\n"
    "The second form tells how A (minus C, if given) differs from B: means per channel, their\n"
    "ratio, root mean square error, and relative mean square error (squared error over squared B,\n"
    "+1 % of its mean squared). So the renderer's indirect light is compared with\n"
    "  reference_picture --compare gi.pfm PREFIX-indirect.pfm --minus none.pfm\n";

struct options {
    const char *source, *prefix, *minus;
    const char *compared[2];
    bool compare, no_environment;
    struct cli_camera camera;
    struct cli_size size;
    uint32_t samples, bounces, seed, threads;
};

struct float_picture {
    uint32_t width, height;
    float *rgb; // 3 floats a pixel
};

// False when the program is to end with *out_status.
static bool parse_options(struct options *options, int argc, char **argv, int *out_status)
{
    struct cli_parser parser = {.usage = usage, .max_arguments = 2};
    cli_take_text(&parser, "out", &options->prefix);
    cli_take_size(&parser, &options->size);
    cli_take_count(&parser, "spp", 1, 1u << 24, &options->samples);
    cli_take_count(&parser, "bounces", 0, PATH_BOUNCES_UNLIMITED, &options->bounces);
    cli_take_camera(&parser, &options->camera);
    cli_take_count(&parser, "seed", 0, UINT32_MAX, &options->seed);
    cli_take_count(&parser, "threads", 1, 256, &options->threads);
    cli_take_flag(&parser, "no-environment", &options->no_environment);
    cli_take_flag(&parser, "compare", &options->compare);
    cli_take_text(&parser, "minus", &options->minus);
    if (!cli_parse(&parser, argc, argv, out_status))
        return false;
    uint32_t wanted = options->compare ? 2 : 1;
    if (parser.argument_count != wanted || (!options->compare && !options->prefix)) {
        fputs(usage, stderr);
        *out_status = CLI_EXIT_USAGE;
        return false;
    }
    options->source = parser.arguments[0];
    options->compared[0] = parser.arguments[0];
    options->compared[1] = parser.arguments[1];
    return true;
}

// Portable Float Map: "PF", size, scale (negative: little endian), rows from the bottom up.
static bool write_pfm(const char *prefix, const char *name, const struct path_picture *picture,
                      const float *const layers[], int layer_count)
{
    char path[4096];
    snprintf(path, sizeof(path), "%s-%s.pfm", prefix, name);
    FILE *file = fopen(path, "wb");
    if (!file) {
        fprintf(stderr, "reference_picture: cannot write \"%s\"\n", path);
        return false;
    }
    double mean[3] = {0};
    fprintf(file, "PF\n%u %u\n-1.0\n", picture->width, picture->height);
    for (uint32_t y = picture->height; y-- > 0;)
        for (uint32_t x = 0; x < picture->width; x++) {
            float rgb[3] = {0};
            for (int c = 0; c < 3; c++) {
                for (int i = 0; i < layer_count; i++)
                    rgb[c] += layers[i][((size_t)y * picture->width + x) * 4 + (size_t)c];
                mean[c] += rgb[c];
            }
            fwrite(rgb, sizeof(rgb), 1, file);
        }
    double pixels = (double)picture->width * picture->height;
    printf("%s mean %.6g %.6g %.6g\n", path, mean[0] / pixels, mean[1] / pixels, mean[2] / pixels);
    bool done = !ferror(file);
    return fclose(file) == 0 && done;
}

static bool read_pfm(const char *path, struct float_picture *out_picture)
{
    struct float_picture picture = {0};
    float scale = 0.0f;
    FILE *file = fopen(path, "rb");
    bool done = file && fscanf(file, "PF %u %u %f", &picture.width, &picture.height, &scale) == 3 &&
                fgetc(file) == '\n' && scale < 0.0f && picture.width > 0 && picture.height > 0 &&
                picture.width <= VIEW_MAX_WIDTH && picture.height <= VIEW_MAX_HEIGHT;
    size_t floats = (size_t)picture.width * picture.height * 3;
    if (done)
        picture.rgb = malloc(floats * sizeof(float));
    done = done && picture.rgb && fread(picture.rgb, sizeof(float), floats, file) == floats;
    if (file)
        fclose(file);
    if (done) {
        *out_picture = picture;
    } else {
        free(picture.rgb);
        fprintf(stderr, "reference_picture: \"%s\" is no little-endian RGB .pfm\n", path);
    }
    return done;
}

static void print_comparison(const struct float_picture *a, const struct float_picture *b)
{
    static const char *const channels[3] = {"red", "green", "blue"};
    double pixels = (double)a->width * a->height, totals[2] = {0};
    for (int c = 0; c < 3; c++) {
        double means[2] = {0}, squared = 0.0, relative = 0.0;
        for (size_t i = (size_t)c; i < (size_t)pixels * 3; i += 3) {
            means[0] += a->rgb[i] / pixels;
            means[1] += b->rgb[i] / pixels;
        }
        for (size_t i = (size_t)c; i < (size_t)pixels * 3; i += 3) {
            double difference = (double)a->rgb[i] - b->rgb[i];
            double reference = (double)b->rgb[i] * b->rgb[i] + 0.01 * means[1] * means[1];
            squared += difference * difference / pixels;
            relative += difference == 0.0 ? 0.0 : difference * difference / reference / pixels;
        }
        printf("%-5s  mean %.6g  expected %.6g  ratio %.4f  RMSE %.6g  relMSE %.6g\n", channels[c],
               means[0], means[1], means[0] / means[1], sqrt(squared), relative);
        totals[0] += means[0];
        totals[1] += means[1];
    }
    printf("energy ratio %.4f\n", totals[0] / totals[1]);
}

static bool compare(const struct options *options)
{
    struct float_picture pictures[3] = {{0}};
    bool done = read_pfm(options->compared[0], &pictures[0]) &&
                read_pfm(options->compared[1], &pictures[1]) &&
                (!options->minus || read_pfm(options->minus, &pictures[2]));
    for (int i = 1; done && i < (options->minus ? 3 : 2); i++)
        if (pictures[i].width != pictures[0].width || pictures[i].height != pictures[0].height) {
            fprintf(stderr, "reference_picture: the pictures differ in size\n");
            done = false;
        }
    if (done) {
        size_t floats = (size_t)pictures[0].width * pictures[0].height * 3;
        for (size_t i = 0; options->minus && i < floats; i++)
            pictures[0].rgb[i] -= pictures[2].rgb[i];
        print_comparison(&pictures[0], &pictures[1]);
    }
    for (int i = 0; i < 3; i++)
        free(pictures[i].rgb);
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
        fprintf(stderr, "reference_picture: out of memory\n");
    const float *const layers[3] = {picture.direct, picture.sky, picture.indirect};
    done = done && write_pfm(options->prefix, "direct", &picture, layers, 1) &&
           write_pfm(options->prefix, "sky", &picture, layers + 1, 1) &&
           write_pfm(options->prefix, "indirect", &picture, layers + 2, 1) &&
           write_pfm(options->prefix, "total", &picture, layers, 3);
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
    return (options.compare ? compare(&options) : render(&options)) ? 0 : 1;
}
