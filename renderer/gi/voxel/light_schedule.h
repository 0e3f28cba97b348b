// Schedules how light converges in a volume over frames: injection into voxels, and generations of
// the irradiance cache, each of which adds one bounce.
#ifndef VOXCAST_RENDERER_GI_VOXEL_LIGHT_SCHEDULE_H
#define VOXCAST_RENDERER_GI_VOXEL_LIGHT_SCHEDULE_H

#include "renderer/frame/frame.h"
#include "renderer/gi/voxel/volume.h"

struct voxel_light_params {
    uint64_t key;      // hash of what light depends on, except the camera
    uint32_t bounces;  // 0: unlimited
    bool multi_bounce; // inject the cache's bounce into voxels
    bool all_faces;    // trace all faces, not only requested ones
    bool cache_shown;  // pixels read the cache instead of gathering the last bounce
    bool camera_moved;
    bool software;
    enum levels_per_frame levels_per_frame;
    uint32_t trace_budget; // cache entries; 0: by time
};

// Plans the frame's work. Call after voxel_volume_update().
void voxel_light_begin(struct voxel_volume *volume, const struct voxel_light_params *params,
                       struct voxel_light_work *out_work);

// Counters after a frame, read back without waiting.
struct voxel_light_report {
    uint32_t overflow; // OVERFLOW_ bits
    uint32_t clamped;  // values outside the range of half floats, since the volume was created
    uint32_t left;
    uint32_t change_bits;
    uint32_t traced;
    uint32_t peak_bits;
};

// Processes the report of a frame that traced generation `generation` in `trace_ms`.
void voxel_light_collect(struct voxel_volume *volume, uint32_t generation,
                         const struct voxel_light_report *report, double trace_ms);

// Convergence of the volume's light, 0 to 1.
float voxel_light_convergence(const struct voxel_volume *volume);

#endif
