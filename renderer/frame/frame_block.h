// Uniforms of a frame: camera, sizes, light and display.
#ifndef VOXCAST_RENDERER_FRAME_FRAME_BLOCK_H
#define VOXCAST_RENDERER_FRAME_FRAME_BLOCK_H

#include "shared/frame_block.h"

struct frame;

// Fills everything but the cascades, which shadow_map_relate_cascades() adds.
void frame_block_fill(const struct frame *frame, struct frame_block *block);

#endif
