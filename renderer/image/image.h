// A decoded image, shared by reference count between scenes and the image cache.
#ifndef VOXCAST_RENDERER_IMAGE_IMAGE_H
#define VOXCAST_RENDERER_IMAGE_IMAGE_H

#include <stdint.h>

#define IMAGE_MAX_EDGE   16384u
#define IMAGE_MAX_BYTES  (256u << 20)    // decoded, of one
#define IMAGES_MAX_BYTES (2048ull << 20) // decoded, of one scene

// 8-bit RGBA, row 0 at the top, `width` x `height` x 4 bytes, values as stored in the file.
struct image {
    uint32_t references; // atomic; a plain type so that C++ can include this
    uint32_t width;
    uint32_t height;
    uint8_t *rgba;
};

// Takes ownership of `rgba` (from malloc, width x height x 4 bytes); the caller holds one
// reference. NULL when out of memory: `rgba` then remains the caller's.
struct image *image_create(uint32_t width, uint32_t height, uint8_t *rgba);

// Adds a reference and returns `image`. Any thread.
struct image *image_retain(struct image *image);

// Drops a reference, frees the image with the last one, and sets *image to NULL. Any thread.
void image_release(struct image **image);

#endif
