// Whether a scene is what scene.h says scenes are, whatever it has been made of.
#ifndef VOXCAST_SERVER_TOOL_STABILITY_SCENE_CHECK_H
#define VOXCAST_SERVER_TOOL_STABILITY_SCENE_CHECK_H

#include "renderer/scene/scene.h"

// What is wrong first, as a few words; NULL if nothing is.
const char *scene_check(const struct scene *scene);

#endif
