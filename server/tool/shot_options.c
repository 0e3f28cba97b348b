#include "server/tool/shot_options.h"

#include <stdio.h>

#include "server/tool/cli.h"

void cli_take_shot(struct cli_parser *parser, struct cli_shot_options *target)
{
    target->camera = (struct cli_camera){0};
    cli_take_size(parser, &target->size);
    cli_take_gpu(parser, &target->gpu);
    cli_take_text(parser, "environment", &target->environment);
    cli_take_camera(parser, &target->camera);
    cli_take_settings(parser, &target->settings);
    target->scene_cache_mib = SCENE_CACHE_DEFAULT_MIB;
    cli_take_count(parser, "scene-cache-mib", 0, SCENE_CACHE_MAX_MIB, &target->scene_cache_mib);
}

static bool apply_options(const struct cli_shot_options *options, enum quality preset,
                          struct shot *shot, struct error *out_error)
{
    struct frame_params *params = &shot->params;
    struct view_options view;
    render_settings_init(&params->settings);
    view_options_init(&view);
    view.width = options->size.width;
    view.height = options->size.height;
    if (!cli_camera_choose(&options->camera, shot->scene, (float)view.width / (float)view.height,
                           &view.camera, out_error) ||
        !cli_settings_apply(&options->settings, preset, shot->scene, &params->settings, &view,
                            out_error))
        return false;
    params->width = view.width;
    params->height = view.height;
    params->camera = view.camera;
    params->quality = view.quality;
    params->debug_view = view.debug_view;
    params->debug_level = view.debug_level;
    params->debug_face = view.debug_face;
    return true;
}

int cli_shot_load(const struct cli_shot_options *options, enum quality preset,
                  struct shot *out_shot)
{
    struct error error = {""};
    scene_cache_open(options->scene_cache_mib);
    struct shot shot = {
        .scene = scene_load_in_environment(options->source, options->environment, &error)};
    if (!shot.scene)
        return cli_fail(CLI_EXIT_SCENE, "%s", error.message);
    for (uint32_t i = 0; i < shot.scene->warning_count; i++)
        fprintf(stderr, "voxcast: warning: %s\n", shot.scene->warnings[i]);
    if (!apply_options(options, preset, &shot, &error)) {
        shot_close(&shot);
        return cli_fail(CLI_EXIT_USAGE, "%s", error.message);
    }
    *out_shot = shot;
    return 0;
}

int cli_shot_start(const struct cli_shot_options *options, struct shot *shot)
{
    struct error error = {""};
    shot->renderer = renderer_create(&(struct renderer_params){.gpu = options->gpu}, &error);
    if (shot->renderer && renderer_set_scene(shot->renderer, shot->scene, &error))
        return 0;
    shot_close(shot);
    return cli_fail(CLI_EXIT_RENDER, "%s", error.message);
}

int cli_shot_open(const struct cli_shot_options *options, enum quality preset,
                  struct shot *out_shot)
{
    int status = cli_shot_load(options, preset, out_shot);
    return status == 0 ? cli_shot_start(options, out_shot) : status;
}
