// Process-wide cache of decoded pictures, so that loading a scene again decodes only what changed.
//
// All functions are thread-safe. The cache holds one reference to each picture; a picture in use by
// a scene costs no memory twice.
#ifndef VOXCAST_RENDERER_IMAGE_IMAGE_CACHE_H
#define VOXCAST_RENDERER_IMAGE_IMAGE_CACHE_H

#include "renderer/image/file_access.h"
#include "renderer/image/image.h"

#define ASSET_CACHE_DEFAULT_BUDGET_BYTES (512ull << 20)
#define ASSET_CACHE_MAX_ENTRIES          8192u

struct asset_key {
    const char *path; // canonical; of the scene file for pictures that lie in it
    struct asset_stamp stamp;
    uint32_t index; // of the picture in its file; 0 for a picture file of its own
};

struct asset_cache_statistics {
    uint64_t hits;
    uint64_t misses;
    uint64_t bytes;
    uint32_t entries;
};

// The picture under `key` with a reference for the caller, or NULL if the file changed or it is
// not held. Cost: a walk over the entries.
struct image *asset_cache_get(const struct asset_key *key);

// Keeps `image` under `key` with a reference of its own, in place of what the same path and index
// held before, and drops the least recently used pictures beyond the budget.
void asset_cache_put(const struct asset_key *key, struct image *image);

// Pictures beyond the new budget are dropped at once; 0 empties the cache.
void asset_cache_set_budget(uint64_t bytes);

struct asset_cache_statistics asset_cache_get_statistics(void);

#endif
