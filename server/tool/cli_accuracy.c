// voxcast accuracy: what accuracy costs in time, for every configuration of a sweep.
#include <cjson/cJSON.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "renderer/clock.h"
#include "renderer/metrics/image_metrics.h"
#include "server/accuracy/accuracy.h"
#include "server/tool/cli.h"
#include "server/tool/shot_options.h"
#include "server/tool/tool_options.h"

#define DEFAULT_FRAMES   12
#define DEFAULT_NOISE    0.01
#define BAR_LENGTH       20u
#define SECONDS_PER_NEWS 10.0

static const char usage[] =
    "usage: voxcast accuracy SCENE|builtin:NAME --out DIR [OPTIONS]\n"
    "\n"
    "Renders (or loads) the reference image, then one view by every configuration of a sweep,\n"
    "and writes into DIR results.json, results.csv, a page with charts (index.html), and images.\n"
    "Each configuration is measured in a scene that has just been loaded: its first image (cold)\n"
    "and the converged one against the reference, frames of a moving camera, memory, and edits of\n"
    "a light. Configurations than which no other is both faster and less wrong are marked as the\n"
    "Pareto front.\n"
    "What is there already of the same set-up is kept: a run that was stopped goes on.\n"
    "\n"
    "  --out DIR            made if it is not there\n"
    "  --ladder NAME|FILE   quick (no indirect light, and the presets), full (52\n"
    "                       configurations), or a file:\n"
    "                       [{\"name\", \"preset\", \"scale\", \"set\": {\"cone_set\": \"9\", "
    "...}}, ...]\n"
    "                       (default quick)\n"
    "  --reference FILE     the reference image, a .pfm of --size\n"
    "  --reference-direct FILE   its emission and what lights and emitters give by one reflection, "
    "to\n"
    "                       judge indirect light alone, too (light of the sky counts as such)\n"
    "  --reference-spp N    trace the reference with N samples a pixel, 1 to 1048576\n"
    "  --until-noise X      trace until its noise is X, 0.0001 to 1 (default 0.01): standard "
    "error\n"
    "                       of pixels over the mean of the image\n"
    "  --frames N           frames of a moving camera that are measured, at most 4 s of them,\n"
    "                       1 to 1000 (default 12)\n"
    "  --edits N            edits of a light that are measured, 0 to 100 (default 1)\n"
    "  --size WxH           1x1 to 4096x2160 (default 640x360)\n"
    "  --environment, --camera, --eye, --target, --up, --fov-y-deg, --gi, --set, --gpu   as\n"
    "                           voxcast render;\n"
    "                       --gi and --set hold for the configurations that do not say\n"
    "                       otherwise\n";

struct accuracy_options {
    struct cli_shot_options shot;
    const char *out, *sweep, *reference, *reference_direct;
    uint32_t spp, frames, edits;
    double until_noise;
};

// When progress of the reference image was last printed.
struct teller {
    double told_ms;
};

static void print_reference(struct teller *teller, const struct accuracy_progress *progress)
{
    double percent = 100.0 * progress->noise, now_ms = clock_now_ms();
    if (progress->stage == ACCURACY_TRACED && progress->samples > 0)
        fprintf(stderr, "voxcast: reference: %u samples a pixel, noise %.2f %%\n",
                progress->samples, percent);
    else if (progress->stage == ACCURACY_TRACED)
        fprintf(stderr, "voxcast: reference: kept from an earlier run, noise %.2f %%\n", percent);
    else if (now_ms - teller->told_ms >= 1e3 * SECONDS_PER_NEWS) {
        teller->told_ms = now_ms;
        fprintf(stderr,
                "voxcast: reference: %u samples a pixel, noise %.2f %%, about %.0f s left\n",
                progress->samples, percent, fmax(progress->left_s, 0.0));
    }
}

static void print_configurations(const struct accuracy_progress *progress)
{
    char bar[BAR_LENGTH + 1];
    double left_s = progress->left_s;
    for (uint32_t i = 0; i < BAR_LENGTH; i++)
        bar[i] = i * progress->configuration_count < progress->done * BAR_LENGTH ? '#' : '.';
    bar[BAR_LENGTH] = '\0';
    if (progress->measured)
        fprintf(stderr, "voxcast: [%s] %u of %u, %s took %.1f s, about %.0f min %02.0f s left\n",
                bar, progress->done, progress->configuration_count, progress->measured->name,
                progress->measured_s, floor(left_s / 60.0), floor(fmod(left_s, 60.0)));
    else if (progress->done > 0)
        fprintf(stderr, "voxcast: %u configurations of the same set-up are there already\n",
                progress->done);
}

static bool tell(void *user, const struct accuracy_progress *progress)
{
    if (progress->stage == ACCURACY_MEASURING)
        print_configurations(progress);
    else
        print_reference(user, progress);
    return true;
}

// Names the metrics by which the reference image is too noisy.
static void warn_of_noise(const cJSON *results)
{
    static const char *const parts[2] = {"metrics", "indirect"};
    const cJSON *noise = cJSON_GetObjectItemCaseSensitive(results, "noise");
    uint32_t count = 0;
    for (int p = 0; p < 2; p++)
        for (int i = 0; i < METRIC_COUNT; i++) {
            const struct image_metric_info *info = &image_metric_infos[i];
            const cJSON *item = cJSON_GetObjectItemCaseSensitive(
                cJSON_GetObjectItemCaseSensitive(noise, parts[p]), info->name);
            if (!cJSON_IsFalse(cJSON_GetObjectItemCaseSensitive(item, "enough")))
                continue;
            fprintf(stderr, "%s%s%s",
                    count++ == 0 ? "voxcast: warning: the reference itself errs by more than a "
                                   "tenth of the smallest error by "
                                 : ", ",
                    info->title, p ? " of indirect light" : "");
        }
    if (count > 0)
        fputs("; it needs more samples\n", stderr);
}

static bool run(const struct accuracy_options *options, struct accuracy *accuracy,
                const struct sweep *sweep, struct error *out_error)
{
    struct teller teller = {.told_ms = clock_now_ms()};
    struct accuracy_watch watch = {.tell = tell, .user = &teller};
    const struct cli_sets *sets = &options->shot.settings.sets;
    cJSON *identity =
        accuracy_identity(options->shot.source, sets->values, sets->count, &accuracy->shot);
    cJSON *results =
        accuracy_run(&(struct accuracy_run){.accuracy = accuracy,
                                            .reference_image =
                                                &(struct reference_image_params){
                                                    .shot = &accuracy->shot,
                                                    .path = options->reference,
                                                    .direct_path = options->reference_direct,
                                                    .samples = options->spp,
                                                    .until_noise = options->until_noise,
                                                    .folder = accuracy->folder,
                                                    .identity = identity,
                                                    .watch = watch,
                                                },
                                            .sweep = sweep,
                                            .with_report = true,
                                            .watch = watch},
                     out_error);
    if (results)
        warn_of_noise(results);
    cJSON_Delete(results);
    cJSON_Delete(identity);
    return results != NULL;
}

// False when the command is to end with *out_status.
static bool parse_options(int argc, char **argv, struct accuracy_options *options, int *out_status)
{
    struct cli_parser parser = {.command = "accuracy", .usage = usage, .max_arguments = 1};
    *options = (struct accuracy_options){
        .shot.size = {640, 360}, .sweep = "quick", .frames = DEFAULT_FRAMES, .edits = 1};
    cli_take_shot(&parser, &options->shot);
    cli_take_text(&parser, "out", &options->out);
    cli_take_text(&parser, "ladder", &options->sweep);
    cli_take_text(&parser, "reference", &options->reference);
    cli_take_text(&parser, "reference-direct", &options->reference_direct);
    cli_take_count(&parser, "reference-spp", 1, 1u << 20, &options->spp);
    cli_take_number(&parser, "until-noise", 1e-4, 1.0, &options->until_noise);
    cli_take_count(&parser, "frames", 1, 1000, &options->frames);
    cli_take_count(&parser, "edits", 0, 100, &options->edits);
    if (!cli_parse(&parser, argc, argv, out_status))
        return false;
    const char *wrong = NULL;
    options->shot.source = parser.arguments[0];
    int references =
        (options->reference != NULL) + (options->spp > 0) + (options->until_noise > 0.0);
    if (parser.argument_count == 0)
        wrong = "no scene given; see voxcast accuracy --help";
    else if (!options->out)
        wrong = "no --out DIR given";
    else if (references > 1)
        wrong = "--reference, --reference-spp and --until-noise exclude each other";
    else if (options->reference_direct && !options->reference)
        wrong = "--reference-direct needs --reference";
    else if (options->shot.settings.preset != CLI_NO_CHOICE ||
             options->shot.settings.view != CLI_NO_CHOICE)
        wrong = "--preset and --view are up to the sweep; see voxcast accuracy --help";
    else if (options->shot.settings.gi == GI_METHOD_REFERENCE)
        wrong = "--gi reference is no configuration to measure; see voxcast accuracy --help";
    if (references == 0)
        options->until_noise = DEFAULT_NOISE;
    if (wrong)
        *out_status = cli_fail(CLI_EXIT_USAGE, "%s", wrong);
    return !wrong;
}

static int open_and_run(const struct accuracy_options *options, struct accuracy *accuracy,
                        const struct sweep *sweep)
{
    struct error error = {""};
    int status = cli_shot_open(&options->shot, QUALITY_HIGH, &accuracy->shot);
    if (status != 0)
        return status;
    if (!run(options, accuracy, sweep, &error))
        status = cli_fail(CLI_EXIT_RENDER, "%s", error.message);
    else if (renderer_gl_error_count(accuracy->shot.renderer) > 0)
        status = cli_fail(CLI_EXIT_RENDER, "the GL driver reported %llu errors",
                          (unsigned long long)renderer_gl_error_count(accuracy->shot.renderer));
    shot_close(&accuracy->shot);
    return status;
}

int cli_accuracy(int argc, char **argv)
{
    struct accuracy_options options;
    struct error error = {""};
    int status;
    if (!parse_options(argc, argv, &options, &status))
        return status;
    struct accuracy accuracy = {
        .folder = options.out, .frames = options.frames, .edits = options.edits};
    struct sweep *sweep = malloc(sizeof(*sweep)); // too large for the stack
    if (!sweep)
        return cli_fail(CLI_EXIT_RENDER, "out of memory");
    if (!sweep_load(options.sweep, sweep, &error))
        status = cli_fail(CLI_EXIT_USAGE, "%s", error.message);
    else if (mkdir(options.out, 0777) != 0 && errno != EEXIST)
        status = cli_fail(CLI_EXIT_OUTPUT, "cannot make \"%s\": %s", options.out, strerror(errno));
    else
        status = open_and_run(&options, &accuracy, sweep);
    free(sweep);
    return status;
}
