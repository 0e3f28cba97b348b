// Global illumination of a renderer: its volumes, and what a frame does with one.
#ifndef VOXCAST_RENDERER_GI_GI_H
#define VOXCAST_RENDERER_GI_GI_H

#include "renderer/gi/gi_method.h"
#include "renderer/path_tracer/progressive.h"

// A clipmap follows a camera; views beyond this number of volumes share one.
#define GI_MAX_SHARED_VOLUMES 6u
// For views whose settings differ from the others' (frame_params.own_voxels).
#define GI_MAX_OWN_VOLUMES 6u
#define GI_MAX_VOLUMES     (GI_MAX_SHARED_VOLUMES + GI_MAX_OWN_VOLUMES)

struct voxel_volume;

struct gi {
    struct gpu *gpu;
    uint32_t volume_count;
    struct gi_volume {
        struct voxel_volume *volume;
        const struct view *owner; // whose camera the clipmap follows; NULL for a shared grid
        bool own;                 // used by its owner only
        uint64_t serial;
    } volumes[GI_MAX_VOLUMES];
    uint64_t next_serial;
    uint32_t trace_budget;        // renderer_params.trace_budget
    struct scene *scene;          // that is shown; NULL for none
    uint64_t scene_number;        // tells apart scenes that were set one after another
    struct live_scene live_scene; // of references
};

void gi_init(struct gi *gi, struct gpu *gpu);
void gi_finish(struct gi *gi);

struct frame;

// Frees what belongs to the former scene. The new one stays the caller's; NULL for none.
void gi_set_scene(struct gi *gi, struct scene *scene);

// The hooks of the frame's method, as gi_method.h describes them; the first tells the frame what
// the method can do.
enum gi_readiness gi_prepare_frame(struct gi *gi, struct frame *frame, bool same);
bool gi_begin_frame(struct gi *gi, struct frame *frame, struct error *out_error);
void gi_bind_frame(const struct frame *frame);
float gi_convergence(const struct frame *frame);

// Frees volumes that are no view's newest.
void gi_release_unused(struct gi *gi, struct view *const *views, uint32_t view_count);

// Frees all volumes, for example when the scene is replaced.
void gi_release_all(struct gi *gi);

struct voxel_volume *gi_find(const struct gi *gi, uint64_t serial);

#endif
