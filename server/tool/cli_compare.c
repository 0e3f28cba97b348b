// voxcast compare: how far one image is from another, by every metric.
#include <cjson/cJSON.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "renderer/metrics/display.h"
#include "renderer/metrics/heat_map.h"
#include "renderer/metrics/image_metrics.h"
#include "renderer/metrics/picture.h"
#include "server/accuracy/bench_run.h"
#include "server/accuracy/picture_file.h"
#include "server/tool/cli.h"
#include "server/tool/tool_options.h"

static const char usage[] =
    "usage: voxcast compare A.pfm B.pfm [OPTIONS]\n"
    "\n"
    "Compares image A with image B, the reference. Both hold linear radiance, as voxcast render\n"
    "writes it. RMSE, MAE, relMSE, the 95th percentile, energy ratios and HDR-FLIP are of "
    "radiance;\n"
    "PSNR, SSIM and LDR-FLIP of displayed pictures, both at one exposure.\n"
    "\n"
    "  --direct FILE      taken away from both: compares indirect light alone\n"
    "  --minus-a FILE     taken away from A alone\n"
    "  --minus-b FILE     taken away from B alone\n"
    "  --exposure-ev E    radiance is scaled by 2^E, -30 to 30 (default: automatic exposure of B,\n"
    "                     before anything is taken away)\n"
    "  --tonemap NAME     hable, aces, khronos_neutral or none (default hable)\n"
    "  --heatmap FILE     a .png of LDR-FLIP, from black (no difference) to pale yellow (1)\n"
    "  --json             JSON on stdout; what is infinite or has no value is null\n";

#define NO_EXPOSURE 1e9

struct compare_options {
    const char *direct, *minus_a, *minus_b, *heatmap;
    double exposure_ev;
    uint32_t tonemap;
    bool json;
};

// Subtracts the light of a file from an image.
static bool subtract_file(struct picture *picture, const char *path, struct error *out_error)
{
    struct picture part;
    if (!path)
        return true;
    if (!picture_read_pfm(path, &part, out_error))
        return false;
    bool done = picture_subtract(picture, &part, out_error);
    picture_finish(&part);
    return done;
}

static bool write_heatmap(const char *path, const struct picture *picture, const float *map,
                          struct error *out_error)
{
    size_t count = picture_pixel_count(picture);
    uint8_t *rgb = malloc(3 * count);
    if (!rgb)
        return error_set(out_error, "out of memory");
    heat_map_colors(map, count, rgb);
    bool done = picture_file_write_png(path, picture->width, picture->height, rgb, out_error);
    free(rgb);
    return done;
}

static void print_metrics(const struct compare_options *options,
                          const struct display_params *display, const struct image_metrics *metrics)
{
    cJSON *root = cJSON_CreateObject();
    cJSON_AddNumberToObject(root, "exposure", (double)display->exposure);
    cJSON_AddStringToObject(root, "tonemap", tonemap_names[display->tonemap]);
    for (int i = 0; i < METRIC_COUNT; i++) {
        const struct image_metric_info *info = &image_metric_infos[i];
        cJSON_AddNumberToObject(root, info->name, metrics->values[i]); // null if not finite
        if (!options->json)
            printf("%-25s %12.6g %s\n", info->title, metrics->values[i], info->unit);
    }
    if (options->json)
        bench_print_json(root);
    cJSON_Delete(root);
}

static bool compare(const struct compare_options *options, struct picture *a, struct picture *b,
                    struct error *out_error)
{
    struct display_params display = {.tonemap = (enum tonemap)options->tonemap};
    struct image_metrics metrics;
    display.exposure = options->exposure_ev == NO_EXPOSURE ? display_automatic_exposure(b)
                                                           : exp2f((float)options->exposure_ev);
    if (!subtract_file(a, options->direct, out_error) ||
        !subtract_file(b, options->direct, out_error) ||
        !subtract_file(a, options->minus_a, out_error) ||
        !subtract_file(b, options->minus_b, out_error))
        return false;
    float *map = malloc(picture_pixel_count(b) * sizeof(float));
    if (!map)
        return error_set(out_error, "out of memory");
    bool done = image_metrics_compute(a, b, &display, &metrics, map, out_error);
    if (done)
        print_metrics(options, &display, &metrics);
    if (done && options->heatmap)
        done = write_heatmap(options->heatmap, b, map, out_error);
    free(map);
    return done;
}

int cli_compare(int argc, char **argv)
{
    struct compare_options options = {.exposure_ev = NO_EXPOSURE, .tonemap = TONEMAP_HABLE};
    struct cli_parser parser = {.command = "compare", .usage = usage, .max_arguments = 2};
    int status;
    cli_take_text(&parser, "direct", &options.direct);
    cli_take_text(&parser, "minus-a", &options.minus_a);
    cli_take_text(&parser, "minus-b", &options.minus_b);
    cli_take_number(&parser, "exposure-ev", -30.0, 30.0, &options.exposure_ev);
    cli_take_choice(&parser, "tonemap", tonemap_names, TONEMAP_COUNT, &options.tonemap);
    cli_take_text(&parser, "heatmap", &options.heatmap);
    cli_take_flag(&parser, "json", &options.json);
    if (!cli_parse(&parser, argc, argv, &status))
        return status;
    if (parser.argument_count != 2)
        return cli_fail(CLI_EXIT_USAGE, "two images are needed; see voxcast compare --help");
    if (options.heatmap && !picture_file_has_extension(options.heatmap, ".png"))
        return cli_fail(CLI_EXIT_USAGE, "--heatmap is \"%s\"; a name that ends with .png is needed",
                        options.heatmap);
    struct error error = {""};
    struct picture a = {0}, b = {0};
    bool done = picture_read_pfm(parser.arguments[0], &a, &error) &&
                picture_read_pfm(parser.arguments[1], &b, &error) &&
                compare(&options, &a, &b, &error);
    picture_finish(&a);
    picture_finish(&b);
    return done ? 0 : cli_fail(CLI_EXIT_OUTPUT, "%s", error.message);
}
