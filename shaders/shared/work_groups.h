// Work-group sizes and what follows from them, in C and GLSL.
#ifndef VOXCAST_SHADERS_SHARED_WORK_GROUPS_H
#define VOXCAST_SHADERS_SHARED_WORK_GROUPS_H

// Of passes with an invocation a pixel. A CPU driver sets up every group anew, so they are large.
#define PIXEL_GROUP_WIDTH  32
#define PIXEL_GROUP_HEIGHT 8

// Of passes that list tiles of this edge, or run in those listed.
#define GROUP_EDGE 8

#define LIGHT_TILE_EDGE 16
#define LINEAR_GROUP    64

#endif
