#include "renderer/gi/gi.h"

#include "renderer/frame/frame.h"
#include "renderer/frame/view.h"

const struct gi_method_hooks gi_none = {0};

const struct gi_method_hooks *const gi_methods[GI_METHOD_COUNT] = {
    [GI_METHOD_NONE] = &gi_none,
    [GI_METHOD_CLIPMAP] = &gi_voxels_clipmap,
    [GI_METHOD_GRID] = &gi_voxels_grid,
    [GI_METHOD_REFERENCE] = &gi_path_traced,
};

static const struct gi_method_hooks *method_of(const struct frame *frame)
{
    return gi_methods[frame->params->settings.gi_method];
}

void gi_init(struct gi *gi, struct gpu *gpu)
{
    *gi = (struct gi){.gpu = gpu, .next_serial = 1};
}

void gi_finish(struct gi *gi)
{
    gi_set_scene(gi, NULL);
}

void gi_set_scene(struct gi *gi, struct scene *scene)
{
    gi_release_all(gi);
    live_scene_finish(&gi->live_scene);
    gi->scene = scene;
    gi->scene_number++;
}

enum gi_readiness gi_prepare_frame(struct gi *gi, struct frame *frame, bool same)
{
    const struct gi_method_hooks *method = method_of(frame);
    for (uint32_t i = 0; i < GI_METHOD_COUNT; i++)
        if (gi_methods[i] != method && gi_methods[i]->leave)
            gi_methods[i]->leave(gi, frame);
    frame->inputs.gi_capabilities = method->capabilities;
    return method->prepare ? method->prepare(gi, frame, same) : GI_READY;
}

bool gi_begin_frame(struct gi *gi, struct frame *frame, struct error *out_error)
{
    const struct gi_method_hooks *method = method_of(frame);
    frame->volume = NULL;
    frame->gi = (struct gi_state){0};
    frame->view->volume_serial = 0;
    if (method->begin && !method->begin(gi, frame, out_error))
        return false;
    frame->view->volume_serial = frame->gi.serial;
    return true;
}

void gi_bind_frame(const struct frame *frame)
{
    const struct gi_method_hooks *method = method_of(frame);
    if (method->bind)
        method->bind(frame);
}

float gi_convergence(const struct frame *frame)
{
    const struct gi_method_hooks *method = method_of(frame);
    return method->convergence ? method->convergence(frame) : 1.0f;
}
