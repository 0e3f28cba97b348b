// Work-group sizes and what follows from them, in C and GLSL.
#ifndef VOXCAST_SHADERS_SHARED_WORK_GROUPS_H
#define VOXCAST_SHADERS_SHARED_WORK_GROUPS_H

#define GROUP_EDGE      8
#define LIGHT_TILE_EDGE 16
#define LINEAR_GROUP    64

#endif
