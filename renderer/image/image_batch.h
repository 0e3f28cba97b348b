// Reads and decodes many images at once, on all cores and through the image cache.
#ifndef VOXCAST_RENDERER_IMAGE_IMAGE_BATCH_H
#define VOXCAST_RENDERER_IMAGE_IMAGE_BATCH_H

#include <stddef.h>

#include "renderer/error.h"
#include "renderer/image/image_cache.h"

#define IMAGE_BATCH_MAX_THREADS 8

// One image: a file (`bytes` NULL), or bytes in memory that outlive the call. `key.path` names the
// file, or the scene file that contains the bytes; NULL bypasses the cache. For image files the
// call fills in the stamp.
struct image_request {
    struct asset_key key;
    const uint8_t *bytes;
    size_t size;
    struct image *image; // result: one reference owned by the caller; NULL with `error` on failure
    struct error error;
};

// Sets image or error of every request. Decodes less than SCENE_MAX_ALL_IMAGES_BYTES in total;
// further images fail. Blocks until all are done.
void image_batch_load(struct image_request *requests, uint32_t count);

#endif
