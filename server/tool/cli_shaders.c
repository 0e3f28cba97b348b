// voxcast shaders: makes the driver compile what a scene's first frames need.
#include <stdio.h>

#include "server/accuracy/converged_frames.h"
#include "server/tool/cli.h"
#include "server/tool/shot_options.h"
#include "server/options.h"

// No powers of two, as in nearly all views: drivers compile special code for those.
#define WIDTH  320u
#define HEIGHT 180u

// The first frame has no history; later frames reproject and average.
#define FRAMES_PER_PRESET 3u

static const char usage[] =
    "usage: voxcast shaders [SCENE] [--gpu auto|software|N] [OPTIONS]\n"
    "\n"
    "Draws small frames of a scene (default " OPTIONS_DEFAULT_SCENE
    ") with the presets that a client meets first, so that the driver\n"
    "compiles their shaders and keeps them on disk: the daemon's first frame then comes at once.\n"
    "Prints lines of \"PERCENT what is under way\". Takes the options of camera and settings, "
    "too,\n"
    "as voxcast render --help lists them.\n";

struct progress {
    uint32_t percent;
    const char *preset;
    uint32_t step; // within the frame
};

static void tell_step(void *user)
{
    struct progress *progress = user;
    printf("%u %s, step %u\n", progress->percent, progress->preset, ++progress->step);
    fflush(stdout);
}

static bool draw(struct shot *shot, struct view *view, struct error *out_error)
{
    struct frame_pixels pixels;
    if (!frames_render_next(shot->renderer, view, &shot->params, &pixels, out_error))
        return false;
    renderer_view_release(shot->renderer, view);
    return true;
}

static bool draw_presets(struct shot *shot, struct progress *progress, struct error *out_error)
{
    // A client's view moves at first, then climbs to its preset.
    const enum quality presets[] = {QUALITY_INTERACTIVE, QUALITY_DRAFT, shot->params.quality};
    const uint32_t count = FRAMES_PER_PRESET * sizeof(presets) / sizeof(presets[0]);
    struct view *view = renderer_view_create(shot->renderer);
    if (!view)
        return error_set(out_error, "there is no memory for a view");
    bool fine = true;
    for (uint32_t i = 0; fine && i < count; i++) {
        shot->params.quality = presets[i / FRAMES_PER_PRESET];
        shot->params.camera.eye[0] += 1e-3f;
        *progress = (struct progress){100 * i / count, quality_names[shot->params.quality], 0};
        tell_step(progress);
        fine = draw(shot, view, out_error);
    }
    renderer_view_destroy(shot->renderer, &view);
    return fine;
}

int cli_shaders(int argc, char **argv)
{
    struct cli_shot_options options = {.size = {WIDTH, HEIGHT}};
    struct cli_parser parser = {.command = "shaders", .usage = usage, .max_arguments = 1};
    struct view_options defaults;
    struct shot shot;
    struct progress progress = {0};
    struct error error = {""};
    int status;
    cli_take_shot(&parser, &options);
    if (!cli_parse(&parser, argc, argv, &status))
        return status;
    options.source = parser.argument_count > 0 ? parser.arguments[0] : OPTIONS_DEFAULT_SCENE;
    view_options_init(&defaults);
    status = cli_shot_load(&options, defaults.quality, &shot);
    if (status != 0)
        return status;
    shot.renderer = renderer_create(
        &(struct renderer_params){.gpu = options.gpu, .yield = tell_step, .user = &progress},
        &error);
    bool fine = shot.renderer && renderer_set_scene(shot.renderer, shot.scene, &error) &&
                draw_presets(&shot, &progress, &error);
    shot_close(&shot);
    return fine ? 0 : cli_fail(CLI_EXIT_RENDER, "%s", error.message);
}
