#include "renderer/gi/voxel/regions.h"

#define MAX_BOXES (VOXEL_MAX_REGIONS / VOXEL_MAX_LEVELS)

bool voxel_box_is_empty(const struct voxel_box *box)
{
    return box->low[0] >= box->high[0] || box->low[1] >= box->high[1] ||
           box->low[2] >= box->high[2];
}

struct voxel_box voxel_box_intersect(const struct voxel_box *a, const struct voxel_box *b)
{
    struct voxel_box result;
    for (int axis = 0; axis < 3; axis++) {
        result.low[axis] = a->low[axis] > b->low[axis] ? a->low[axis] : b->low[axis];
        result.high[axis] = a->high[axis] < b->high[axis] ? a->high[axis] : b->high[axis];
    }
    return result;
}

bool voxel_box_contains(const struct voxel_box *outer, const struct voxel_box *inner)
{
    for (int axis = 0; axis < 3; axis++)
        if (inner->low[axis] < outer->low[axis] || inner->high[axis] > outer->high[axis])
            return false;
    return true;
}

static struct voxel_box bounds_of(const struct voxel_box *a, const struct voxel_box *b)
{
    struct voxel_box result;
    for (int axis = 0; axis < 3; axis++) {
        result.low[axis] = a->low[axis] < b->low[axis] ? a->low[axis] : b->low[axis];
        result.high[axis] = a->high[axis] > b->high[axis] ? a->high[axis] : b->high[axis];
    }
    return result;
}

void voxel_boxes_entered(struct voxel_boxes *boxes, const struct voxel_box *before,
                         const struct voxel_box *now)
{
    boxes->count = 0;
    struct voxel_box kept = voxel_box_intersect(before, now);
    if (voxel_box_is_empty(&kept)) {
        boxes->boxes[boxes->count++] = *now;
        return;
    }
    struct voxel_box rest = *now;
    for (int axis = 0; axis < 3; axis++) {
        struct voxel_box slab = rest;
        if (rest.low[axis] < kept.low[axis]) {
            slab.high[axis] = kept.low[axis];
            rest.low[axis] = kept.low[axis];
        } else if (rest.high[axis] > kept.high[axis]) {
            slab.low[axis] = kept.high[axis];
            rest.high[axis] = kept.high[axis];
        } else {
            continue;
        }
        boxes->boxes[boxes->count++] = slab;
    }
}

void voxel_boxes_add(struct voxel_boxes *boxes, struct voxel_box box)
{
    if (voxel_box_is_empty(&box))
        return;
    for (uint32_t i = 0; i < boxes->count;) {
        struct voxel_box overlap = voxel_box_intersect(&boxes->boxes[i], &box);
        bool full = boxes->count == MAX_BOXES && i + 1 == boxes->count;
        if (voxel_box_is_empty(&overlap) && !full) {
            i++;
            continue;
        }
        // The merged box may overlap others that the smaller one did not: start over.
        box = bounds_of(&boxes->boxes[i], &box);
        boxes->boxes[i] = boxes->boxes[--boxes->count];
        i = 0;
    }
    boxes->boxes[boxes->count++] = box;
}
