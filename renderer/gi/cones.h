// Sets of cones over a hemisphere.
#ifndef VOXCAST_RENDERER_GI_CONES_H
#define VOXCAST_RENDERER_GI_CONES_H

#include "renderer/settings.h"
#include "shared/voxel.h"

struct cone_directions {
    uint32_t count;
    float tangent;                   // of the half-angle
    float cones[VOXEL_MAX_CONES][4]; // unit direction about +Z; weight: cosine over the sum of them
};

// `set` is not CONE_SET_AUTO.
void cone_directions_init(struct cone_directions *directions, enum cone_set set);

#endif
