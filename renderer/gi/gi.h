// Global illumination of a renderer: its volumes, and what a frame does with one.
#ifndef VOXCAST_RENDERER_GI_GI_H
#define VOXCAST_RENDERER_GI_GI_H

#include "renderer/frame/effects.h"
#include "renderer/gi/light_schedule.h"

// A clipmap follows a camera; views beyond this number of volumes share one.
#define GI_MAX_SHARED_VOLUMES 6u
// For views whose settings differ from the others' (frame_params.own_voxels).
#define GI_MAX_OWN_VOLUMES 6u
#define GI_MAX_VOLUMES     (GI_MAX_SHARED_VOLUMES + GI_MAX_OWN_VOLUMES)

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
    uint32_t trace_budget; // renderer_params.trace_budget
};

void gi_init(struct gi *gi, struct gpu *gpu);
void gi_finish(struct gi *gi);

struct frame;

// Finds or creates the frame's volume and plans the frame's work on it. Leaves frame->volume NULL
// if no effect needs voxels. False with a message when memory runs out.
bool gi_begin_frame(struct gi *gi, struct frame *frame, struct error *out_error);

// Plans the final gather; call once the frame's size is known. Pixels show the cache until light
// has converged, then gather; samples accumulate while nothing moves. False with a message when
// memory runs out.
bool gi_plan_accumulation(struct frame *frame, struct error *out_error);

// Frees volumes that are no view's newest.
void gi_release_unused(struct gi *gi, struct view *const *views, uint32_t view_count);

// Frees all volumes, for example when the scene is replaced.
void gi_release_all(struct gi *gi);

struct voxel_volume *gi_find(const struct gi *gi, uint64_t serial);

#endif
