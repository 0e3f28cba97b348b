// Uniforms of a frame: camera, sizes, light and display.
#ifndef VOXCAST_RENDERER_FRAME_FRAME_BLOCK_H
#define VOXCAST_RENDERER_FRAME_FRAME_BLOCK_H

#include "shared/frame_block.h"

struct frame;
struct scene_tables;

// From world space, relative to the GPU scene's origin, to clip space with reversed Z.
void frame_clip_from_world(const struct frame *frame, mat4 out_clip_from_world);

// Where the scene's tables begin.
void frame_block_fill_tables(const struct scene_tables *tables, struct frame_block *block);

// Fills everything but the cascades, which shadow_map_relate_cascades() adds.
void frame_block_fill(const struct frame *frame, struct frame_block *block);

#endif
