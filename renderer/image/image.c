#include "renderer/image/image.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

#include "renderer/image/image_decode.h"

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
    pthread_mutex_init(&image->mutex, NULL);
    return image;
}

void image_keep_file(struct image *image, const uint8_t *file, size_t file_size)
{
    if (file_size > (size_t)image->width * image->height * 2) {
        return;
    }
    image->file = malloc(file_size);
    if (image->file) {
        memcpy(image->file, file, file_size);
        image->file_size = file_size;
    }
}

struct image *image_create_undecoded(uint32_t width, uint32_t height, const uint8_t *file,
                                     size_t file_size)
{
    struct image *image = image_create(width, height, NULL);
    if (image) {
        image_keep_file(image, file, file_size);
    }
    if (image && !image->file) {
        image_release(&image);
    }
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
    pthread_mutex_destroy(&released->mutex);
    free(released->rgba);
    free(released->file);
    free(released);
}

// Fetches the pixels from the file's bytes; call with the mutex held.
static void decode(struct image *image)
{
    struct image *decoded = image_decode(image->file, image->file_size, NULL);
    if (decoded && decoded->width == image->width && decoded->height == image->height) {
        image->rgba = decoded->rgba;
        decoded->rgba = NULL;
    }
    image_release(&decoded);
}

bool image_pin(struct image *image)
{
    pthread_mutex_lock(&image->mutex);
    if (!image->rgba) {
        decode(image);
    }
    bool pinned = image->rgba != NULL;
    image->pins += pinned;
    pthread_mutex_unlock(&image->mutex);
    return pinned;
}

void image_unpin(struct image *image)
{
    pthread_mutex_lock(&image->mutex);
    assert(image->pins > 0);
    if (--image->pins == 0 && image->file) {
        free(image->rgba);
        image->rgba = NULL;
    }
    pthread_mutex_unlock(&image->mutex);
}

void image_add_to_key(const struct image *image, struct cache_key *key)
{
    const uint32_t size[2] = {image->width, image->height};
    cache_key_add(key, size, sizeof(size));
    if (image->file) {
        cache_key_add(key, image->file, image->file_size);
    } else {
        cache_key_add(key, image->rgba, (size_t)image->width * image->height * 4);
    }
}
