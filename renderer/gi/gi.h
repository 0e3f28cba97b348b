// Global illumination of a renderer: what its methods keep, and what a frame asks of its own.
#ifndef VOXCAST_RENDERER_GI_GI_H
#define VOXCAST_RENDERER_GI_GI_H

#include "renderer/gi/gi_method.h"

struct gi {
    struct gpu *gpu;
    uint64_t next_serial;        // tells apart what methods keep, whichever method it is
    uint32_t trace_budget;       // renderer_params.trace_budget
    struct scene *scene;         // that is shown; NULL for none
    uint64_t scene_number;       // tells apart scenes that were set one after another
    void *kept[GI_METHOD_COUNT]; // by each method, which allocates and frees it; NULL for nothing
};

void gi_init(struct gi *gi, struct gpu *gpu);
void gi_finish(struct gi *gi);

struct frame;
struct ring_frame;
struct view;

// Frees what belongs to the former scene. The new one stays the caller's; NULL for none.
void gi_set_scene(struct gi *gi, struct scene *scene);

// The hooks of the frame's method, as gi_method.h describes them; the first tells the frame what
// the method can do.
enum gi_readiness gi_prepare_frame(struct gi *gi, struct frame *frame, bool same);
bool gi_begin_frame(struct gi *gi, struct frame *frame, struct error *out_error);
void gi_bind_frame(const struct frame *frame);
float gi_convergence(const struct frame *frame);

// Hands a finished frame's report, VIEW_REPORT_BYTES of it, to its method.
void gi_collect(struct gi *gi, struct view *view, const struct ring_frame *slot, const void *bytes);

// What the view's newest frame was drawn with; nothing if no method keeps it.
void gi_inspect(const struct gi *gi, const struct view *view, struct gi_findings *out_findings);

// Frees what no view's newest frame was drawn with, whichever method keeps it.
void gi_release_unused(struct gi *gi, struct view *const *views, uint32_t view_count);

#endif
