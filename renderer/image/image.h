// An image, shared by reference count between scenes and the image cache.
//
// Pixels that can be decoded again go when the last who has pinned them unpins them: decoded images
// are the largest part of most scenes, and once they are on the GPU hardly anybody reads them.
#ifndef VOXCAST_RENDERER_IMAGE_IMAGE_H
#define VOXCAST_RENDERER_IMAGE_IMAGE_H

#include <pthread.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "renderer/cache/scene_cache.h"

#define IMAGE_MAX_EDGE   16384u
#define IMAGE_MAX_BYTES  (256u << 20)    // decoded, of one
#define IMAGES_MAX_BYTES (2048ull << 20) // decoded, of one scene

// 8-bit RGBA, row 0 at the top, `width` x `height` x 4 bytes, values as stored in the file.
struct image {
    uint32_t references; // atomic; a plain type so that C++ can include this
    uint32_t width;
    uint32_t height;
    uint8_t *rgba;    // read it only while pinned, or where there is no file
    uint8_t *file;    // bytes to decode it from; NULL: `rgba` stays
    size_t file_size; // of them
    uint32_t pins;
    pthread_mutex_t mutex; // guards `pins` and `rgba`
};

// Takes ownership of `rgba` (from malloc, width x height x 4 bytes); the caller holds one
// reference. NULL when out of memory: `rgba` then remains the caller's.
struct image *image_create(uint32_t width, uint32_t height, uint8_t *rgba);

// An image without pixels, to be decoded from a copy of these bytes, which image_decode() is known
// to accept. NULL when out of memory, and where the bytes are too many to keep.
struct image *image_create_undecoded(uint32_t width, uint32_t height, const uint8_t *file,
                                     size_t file_size);

// Lets pixels go when nobody pins them, by keeping a copy of the bytes that they were decoded from.
// Does nothing when memory is short, and where the bytes are too many to be worth it. For an image
// that nobody else has yet.
void image_keep_file(struct image *image, const uint8_t *file, size_t file_size);

// Adds a reference and returns `image`. Any thread.
struct image *image_retain(struct image *image);

// Drops a reference, frees the image with the last one, and sets *image to NULL. Any thread.
void image_release(struct image **image);

// Makes the pixels stay until image_unpin(); decodes them if need be. False, and nothing is pinned,
// when memory is short. Any thread.
bool image_pin(struct image *image);
void image_unpin(struct image *image);

// Adds what decides the image's pixels to a key of the scene cache.
void image_add_to_key(const struct image *image, struct cache_key *key);

#endif
