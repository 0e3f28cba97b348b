// Cone sets over a hemisphere.
#ifndef VOXCAST_RENDERER_GI_VOXEL_CONES_H
#define VOXCAST_RENDERER_GI_VOXEL_CONES_H

#include "renderer/settings.h"
#include "shared/voxel_block.h"

struct cone_directions {
    uint32_t count;
    float tangent; // of the half-angle
    struct voxel_cone cones[VOXEL_MAX_CONES];
};

uint32_t cone_set_count(enum cone_set set);

// `set` must not be CONE_SET_AUTO.
void cone_directions_init(struct cone_directions *directions, enum cone_set set);

#endif
