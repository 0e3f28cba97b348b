// The reference as a method: paths that are traced on the CPU (renderer/path_tracer/) while nothing
// moves. Until every pixel has a sample, the frame is drawn by direct light.
#include <stdlib.h>

#include "renderer/frame/frame.h"
#include "renderer/frame/view.h"
#include "renderer/gi/gi.h"
#include "renderer/log.h"
#include "renderer/path_tracer/progressive.h"

static bool shows_reference(const struct frame_params *params)
{
    return (params->debug_view == DEBUG_VIEW_FINAL || params->debug_view == DEBUG_VIEW_DIRECT);
}

// The snapshot that all views' references trace; NULL when out of memory.
static struct live_scene *keep_scene(struct gi *gi)
{
    void **kept = &gi->kept[GI_METHOD_REFERENCE];
    if (!*kept)
        *kept = calloc(1, sizeof(struct live_scene));
    return *kept;
}

static enum gi_readiness prepare(struct gi *gi, struct frame *frame, bool same)
{
    struct view *view = frame->view;
    const struct frame_params *params = frame->params;
    const struct render_settings *settings = &params->settings;
    if (!shows_reference(params)) {
        live_reference_finish(&view->reference);
        return GI_READY;
    }
    const struct live_params wanted = {
        .scene = gi->scene,
        .scene_number = gi->scene_number,
        .camera = params->camera,
        .width = params->width,
        .height = params->height,
        .max_bounces = settings->bounces ? settings->bounces : REFERENCE_UNLIMITED,
        .all_blinn_phong = settings->shading_model == SHADING_MODEL_BLINN_PHONG,
        .direct_only = params->debug_view == DEBUG_VIEW_DIRECT,
    };
    struct error error = {""};
    struct live_scene *scene = keep_scene(gi);
    enum live_state state = LIVE_WAITING;
    if (scene)
        state = live_reference_update(&view->reference, scene, &wanted, &error);
    else
        error_set(&error, "out of memory");
    if (error.message[0])
        log_write(LOG_ERROR, "reference_failed reason=\"%s\"", error.message);
    if (same && state == LIVE_FINISHED)
        return GI_UNCHANGED;
    if (same && state != LIVE_NEW)
        return GI_PENDING;
    if (view->reference.shown_samples > 0)
        frame->reference_picture = view->reference.rgba;
    frame->inputs.reference_shown = frame->reference_picture != NULL;
    return GI_READY;
}

static float convergence(const struct frame *frame)
{
    return shows_reference(frame->params) ? live_reference_convergence(&frame->view->reference)
                                          : 1.0f;
}

static void leave(struct gi *gi, struct frame *frame)
{
    (void)gi;
    live_reference_finish(&frame->view->reference);
}

static void release(struct gi *gi)
{
    struct live_scene *scene = gi->kept[GI_METHOD_REFERENCE];
    if (scene)
        live_scene_finish(scene);
    free(scene);
    gi->kept[GI_METHOD_REFERENCE] = NULL;
}

// A snapshot that is being built stays until a later frame: waiting for it would take seconds.
static void release_unused(struct gi *gi, struct view *const *views, uint32_t view_count)
{
    const struct live_scene *scene = gi->kept[GI_METHOD_REFERENCE];
    bool used = !scene || live_scene_is_building(scene);
    for (uint32_t i = 0; i < view_count; i++)
        used = used || live_reference_is_used(&views[i]->reference);
    if (!used)
        release(gi);
}

const struct gi_method_hooks gi_path_traced = {
    .capabilities = GI_IS_REFERENCE,
    .prepare = prepare,
    .convergence = convergence,
    .leave = leave,
    .release_unused = release_unused,
    .release = release,
};
