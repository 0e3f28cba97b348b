#include "renderer/scene/pinned_images.h"

#include <stdlib.h>

static bool masks_something(const struct scene *scene, uint32_t image)
{
    for (uint32_t i = 0; i < scene->material_count; i++)
        if (scene->materials[i].alpha_mode == SCENE_ALPHA_MASK &&
            scene->materials[i].textures[SCENE_TEXTURE_BASE_COLOR].image == image)
            return true;
    return false;
}

bool pinned_images_take(struct pinned_images *pinned, const struct scene *scene, bool masks_only)
{
    // What stays pinned need not be decoded again.
    struct pinned_images before = *pinned;
    *pinned = (struct pinned_images){
        .images = calloc(scene->image_count ? scene->image_count : 1, sizeof(*pinned->images))};
    bool done = pinned->images != NULL;
    for (uint32_t i = 0; i < scene->image_count && pinned->images; i++) {
        if (masks_only && !masks_something(scene, i))
            continue;
        if (image_pin(scene->images[i]))
            pinned->images[pinned->count++] = image_retain(scene->images[i]);
        else
            done = false;
    }
    pinned_images_release(&before);
    return done;
}

void pinned_images_release(struct pinned_images *pinned)
{
    for (uint32_t i = 0; i < pinned->count; i++) {
        image_unpin(pinned->images[i]);
        image_release(&pinned->images[i]);
    }
    free(pinned->images);
    *pinned = (struct pinned_images){0};
}
