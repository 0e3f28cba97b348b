// Reads and decodes many pictures at once, on all cores and through the asset cache.
#ifndef VOXCAST_RENDERER_IMAGE_IMAGE_BATCH_H
#define VOXCAST_RENDERER_IMAGE_IMAGE_BATCH_H

#include <stddef.h>

#include "renderer/error.h"
#include "renderer/image/image_cache.h"

#define IMAGE_BATCH_MAX_THREADS 8

// One picture: a file (`bytes` NULL), or bytes in memory that outlive the call. `key.path` names
// the file, or the scene file that holds the bytes, or is NULL to bypass the cache. The stamp of a
// picture file is filled in here.
struct image_request {
    struct asset_key key;
    const uint8_t *bytes;
    size_t size;
    struct image *image; // result: one reference, the caller's; NULL with `error` on failure
    struct error error;
};

// Fills image or error of every request. The pictures together stay below
// IMAGES_MAX_BYTES; those beyond it fail. Blocks until all are done.
void image_batch_load(struct image_request *requests, uint32_t count);

#endif
