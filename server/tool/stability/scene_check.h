// Whether a scene fulfils scene.h, wherever it came from.
#ifndef VOXCAST_SERVER_TOOL_STABILITY_SCENE_CHECK_H
#define VOXCAST_SERVER_TOOL_STABILITY_SCENE_CHECK_H

#include "renderer/scene/scene.h"

// The first violation, as a few words; NULL if there is none.
const char *scene_check(const struct scene *scene);

#endif
