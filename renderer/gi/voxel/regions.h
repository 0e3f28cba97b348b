// Boxes of voxels, and which of them to refill when a level or an object moves. Pure functions.
#ifndef VOXCAST_RENDERER_GI_VOXEL_REGIONS_H
#define VOXCAST_RENDERER_GI_VOXEL_REGIONS_H

#include <stdbool.h>
#include <stdint.h>

#include "shared/voxel_records.h"
#include "shared/voxel_work.h"

// Voxels of one level: low <= v < high.
struct voxel_box {
    int32_t low[3];
    int32_t high[3];
};

// Disjoint boxes of one level.
struct voxel_boxes {
    uint32_t count;
    struct voxel_box boxes[VOXEL_MAX_REGIONS / VOXEL_MAX_LEVELS];
};

bool voxel_box_is_empty(const struct voxel_box *box);
struct voxel_box voxel_box_intersect(const struct voxel_box *a, const struct voxel_box *b);
bool voxel_box_contains(const struct voxel_box *outer, const struct voxel_box *inner);

// The part of `now` that `before` does not cover, as up to three disjoint slabs; all of `now` if
// they do not overlap. Both have the same size.
void voxel_boxes_entered(struct voxel_boxes *boxes, const struct voxel_box *before,
                         const struct voxel_box *now);

// Adds a box and merges it with those it overlaps into common bounds. Beyond the capacity merges
// the last two. `bounds` limits the result: a merged box never leaves it.
void voxel_boxes_add(struct voxel_boxes *boxes, struct voxel_box box);

#endif
