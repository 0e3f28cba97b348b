// How light spreads through a volume's voxels from frame to frame: relighting, and generations of
// the irradiance cache, each of which adds one bounce.
#ifndef VOXCAST_RENDERER_GI_LIGHT_SCHEDULE_H
#define VOXCAST_RENDERER_GI_LIGHT_SCHEDULE_H

#include "renderer/frame/frame.h"
#include "renderer/gi/volume.h"

struct voxel_light_params {
    uint64_t key;      // of everything that light depends on, but for where the camera is
    uint32_t bounces;  // 0: unlimited
    bool multi_bounce; // voxels reflect what the cache holds
    bool all_faces;    // are wanted, rather than those that pixels ask for
    bool cache_shown;  // pixels read the cache, rather than gather the last bounce themselves
    bool camera_moved;
    bool software;
    enum levels_per_frame levels_per_frame;
    uint32_t trace_budget; // entries; 0: by time
};

// Decides what the frame does. After voxel_volume_update().
void voxel_light_begin(struct voxel_volume *volume, const struct voxel_light_params *params,
                       struct voxel_light_work *out_work);

// What the counters said when a frame was done, read back without waiting.
struct voxel_light_report {
    uint32_t overflow; // OVERFLOW_ bits
    uint32_t clamped;  // values that half floats do not hold, since the volume was made
    uint32_t left;
    uint32_t change_bits;
    uint32_t traced;
    uint32_t peak_bits;
};

// Takes in the report of a frame that traced generation `generation` in `trace_ms`.
void voxel_light_collect(struct voxel_volume *volume, uint32_t generation,
                         const struct voxel_light_report *report, double trace_ms);

// 0 to 1: how far the volume's light has come.
float voxel_light_convergence(const struct voxel_volume *volume);

#endif
