// Accumulation of what pixels gather.
#ifndef VOXCAST_RENDERER_GI_VOXEL_ACCUMULATION_H
#define VOXCAST_RENDERER_GI_VOXEL_ACCUMULATION_H

#include "renderer/error.h"
#include "renderer/frame/frame.h"

// Plans the final gather, once the frame's size is known. Pixels show the cache until light has
// converged, then gather; samples accumulate while nothing moves. False with a message when memory
// runs out.
bool gi_plan_accumulation(struct frame *frame, struct error *out_error);

#endif
