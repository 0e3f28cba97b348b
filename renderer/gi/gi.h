// Global illumination of a renderer: its volumes, and what a frame of a view does with one.
#ifndef VOXCAST_RENDERER_GI_GI_H
#define VOXCAST_RENDERER_GI_GI_H

#include "renderer/frame/effects.h"
#include "renderer/gi/light_schedule.h"

// Clipmaps follow cameras; views beyond so many volumes share one.
#define GI_MAX_SHARED_VOLUMES 6u
// Of views whose settings are not those of others (frame_params.own_voxels).
#define GI_MAX_OWN_VOLUMES 6u
#define GI_MAX_VOLUMES     (GI_MAX_SHARED_VOLUMES + GI_MAX_OWN_VOLUMES)

struct gi {
    struct gpu *gpu;
    uint32_t volume_count;
    struct gi_volume {
        struct voxel_volume *volume;
        const struct view *owner; // whose camera a clipmap follows; NULL for a shared grid
        bool own;                 // used by nobody but its owner
        uint64_t serial;
    } volumes[GI_MAX_VOLUMES];
    uint64_t next_serial;
    uint32_t trace_budget; // of renderer_params
};

void gi_init(struct gi *gi, struct gpu *gpu);
void gi_finish(struct gi *gi);

struct frame;

// Finds or makes the frame's volume and decides what the frame does. Leaves frame->volume NULL
// where no effect needs voxels. False with a message when memory ends.
bool gi_begin_frame(struct gi *gi, struct frame *frame, struct error *out_error);

// Decides how pixels gather, once the frame's size is known: when the light has settled; until then
// they show the cache. While nothing moves their pictures are averaged. False with a message when
// memory ends.
bool gi_plan_accumulation(struct frame *frame, struct error *out_error);

// Frees volumes that no view has drawn with last.
void gi_release_unused(struct gi *gi, struct view *const *views, uint32_t view_count);

// Frees all volumes, such as when another scene comes.
void gi_release_all(struct gi *gi);

struct voxel_volume *gi_find(const struct gi *gi, uint64_t serial);

#endif
