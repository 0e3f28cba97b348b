// Process-wide cache of decoded images: loading a scene again decodes only what has changed.
//
// All functions are thread-safe. The cache holds one reference per image; an image that a scene
// uses is stored once.
#ifndef VOXCAST_RENDERER_IMAGE_IMAGE_CACHE_H
#define VOXCAST_RENDERER_IMAGE_IMAGE_CACHE_H

#include "renderer/image/file_access.h"
#include "renderer/image/image.h"

#define ASSET_CACHE_DEFAULT_BUDGET_BYTES (512ull << 20)
#define ASSET_CACHE_MAX_ENTRIES          8192u

struct asset_key {
    const char *path; // canonical; for embedded images the scene file's
    struct asset_stamp stamp;
    uint32_t index; // of an embedded image in its file; 0 for an image file
};

struct asset_cache_statistics {
    uint64_t hits;
    uint64_t misses;
    uint64_t bytes;
    uint32_t entries;
};

// The image under `key`, with a reference for the caller; NULL if it is not cached or the file has
// changed. Cost: linear in the entries.
struct image *asset_cache_get(const struct asset_key *key);

// Stores `image` under `key` with a reference of its own, replaces the entry of the same path and
// index, and evicts the least recently used images beyond the budget.
void asset_cache_put(const struct asset_key *key, struct image *image);

// Evicts images beyond the new budget at once; 0 empties the cache.
void asset_cache_set_budget(uint64_t bytes);

struct asset_cache_statistics asset_cache_get_statistics(void);

#endif
