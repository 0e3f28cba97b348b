// Images of a scene whose pixels somebody reads for a while.
#ifndef VOXCAST_RENDERER_SCENE_PINNED_IMAGES_H
#define VOXCAST_RENDERER_SCENE_PINNED_IMAGES_H

#include "renderer/scene/scene.h"

// Zero for none.
struct pinned_images {
    struct image **images; // pinned, and a reference to each
    uint32_t count;
};

// Pins all of the scene's images, or those alone that materials are masked by, instead of what was
// pinned before. False when memory is short: then some are not pinned.
bool pinned_images_take(struct pinned_images *pinned, const struct scene *scene, bool masks_only);
void pinned_images_release(struct pinned_images *pinned);

#endif
