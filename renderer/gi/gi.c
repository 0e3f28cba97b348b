#include "renderer/gi/gi.h"

#include "renderer/frame/frame.h"
#include "renderer/frame/view.h"

const struct gi_method_hooks gi_none = {0};

const struct gi_method_hooks *const gi_methods[GI_METHOD_COUNT] = {
#define HOOKS_OF(id, hooks) [GI_METHOD_##id] = &hooks,
    GI_METHOD_ROWS(HOOKS_OF)
#undef HOOKS_OF
};

#define ONE(id, hooks) +1
_Static_assert(0 GI_METHOD_ROWS(ONE) == GI_METHOD_COUNT, "each method of enums.def has its row");
#undef ONE

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
    for (uint32_t i = 0; i < GI_METHOD_COUNT; i++)
        if (gi_methods[i]->release)
            gi_methods[i]->release(gi);
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
    frame->method_data = NULL;
    frame->gi = (struct gi_state){0};
    frame->view->gi_method = frame->params->settings.gi_method;
    frame->view->gi_serial = 0;
    if (method->begin && !method->begin(gi, frame, out_error))
        return false;
    frame->view->gi_serial = frame->gi.serial;
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

void gi_collect(struct gi *gi, struct view *view, const struct ring_frame *slot, const void *bytes)
{
    const struct gi_method_hooks *method = gi_methods[slot->gi_method];
    const struct gi_report report = {
        .view = view, .serial = slot->gi_serial, .tag = slot->gi_report_tag, .bytes = bytes};
    if (method->collect && report.serial != 0)
        method->collect(gi, &report);
}

void gi_inspect(const struct gi *gi, const struct view *view, struct gi_findings *out_findings)
{
    const struct gi_method_hooks *method = gi_methods[view->gi_method];
    *out_findings = (struct gi_findings){0};
    if (method->inspect && view->gi_serial != 0)
        method->inspect(gi, view->gi_serial, out_findings);
}

void gi_release_unused(struct gi *gi, struct view *const *views, uint32_t view_count)
{
    for (uint32_t i = 0; i < GI_METHOD_COUNT; i++)
        if (gi_methods[i]->release_unused)
            gi_methods[i]->release_unused(gi, views, view_count);
}
