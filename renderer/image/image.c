#include "renderer/image/image.h"

#include <stdlib.h>

struct image *image_create(uint32_t width, uint32_t height, uint8_t *rgba)
{
    struct image *image = calloc(1, sizeof(*image));
    if (!image) {
        return NULL;
    }
    image->references = 1;
    image->width = width;
    image->height = height;
    image->rgba = rgba;
    return image;
}

struct image *image_retain(struct image *image)
{
    __atomic_fetch_add(&image->references, 1, __ATOMIC_RELAXED);
    return image;
}

void image_release(struct image **image)
{
    struct image *released = *image;
    *image = NULL;
    if (!released || __atomic_fetch_sub(&released->references, 1, __ATOMIC_ACQ_REL) != 1) {
        return;
    }
    free(released->rgba);
    free(released);
}
