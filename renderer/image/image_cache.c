#include "renderer/image/image_cache.h"

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "renderer/hash.h"

struct asset_entry {
    char *path;
    uint64_t path_hash;
    struct asset_stamp stamp;
    uint32_t index;
    uint64_t last_use; // number of the newest call that used it
    struct image *image;
};

static struct {
    pthread_mutex_t mutex;
    struct asset_entry *entries;
    uint32_t capacity;
    uint64_t budget_bytes;
    uint64_t use_counter;
    struct asset_cache_statistics statistics;
} cache = {.mutex = PTHREAD_MUTEX_INITIALIZER, .budget_bytes = ASSET_CACHE_DEFAULT_BUDGET_BYTES};

static uint64_t image_bytes(const struct image *image)
{
    return (uint64_t)image->width * image->height * 4;
}

static struct asset_entry *find_entry(const struct asset_key *key)
{
    uint64_t hash = hash_bytes(HASH_START, key->path, strlen(key->path));
    for (uint32_t i = 0; i < cache.statistics.entries; i++) {
        struct asset_entry *entry = &cache.entries[i];
        if (entry->path_hash == hash && entry->index == key->index &&
            strcmp(entry->path, key->path) == 0) {
            return entry;
        }
    }
    return NULL;
}

static void drop_entry(struct asset_entry *entry)
{
    cache.statistics.bytes -= image_bytes(entry->image);
    image_release(&entry->image);
    free(entry->path);
    *entry = cache.entries[--cache.statistics.entries];
}

static void drop_beyond_budget(void)
{
    while (cache.statistics.entries > 0 && (cache.statistics.bytes > cache.budget_bytes ||
                                            cache.statistics.entries > ASSET_CACHE_MAX_ENTRIES)) {
        struct asset_entry *oldest = &cache.entries[0];
        for (uint32_t i = 1; i < cache.statistics.entries; i++) {
            if (cache.entries[i].last_use < oldest->last_use) {
                oldest = &cache.entries[i];
            }
        }
        drop_entry(oldest);
    }
}

struct image *asset_cache_get(const struct asset_key *key)
{
    struct image *image = NULL;
    pthread_mutex_lock(&cache.mutex);
    struct asset_entry *entry = find_entry(key);
    if (entry && entry->stamp.size_bytes == key->stamp.size_bytes &&
        entry->stamp.modified_ns == key->stamp.modified_ns) {
        entry->last_use = ++cache.use_counter;
        image = image_retain(entry->image);
        cache.statistics.hits++;
    } else {
        cache.statistics.misses++;
    }
    pthread_mutex_unlock(&cache.mutex);
    return image;
}

static bool reserve_entry(void)
{
    if (cache.statistics.entries < cache.capacity) {
        return true;
    }
    uint32_t capacity = cache.capacity ? cache.capacity * 2 : 64;
    struct asset_entry *entries = realloc(cache.entries, capacity * sizeof(*entries));
    if (!entries) {
        return false;
    }
    cache.entries = entries;
    cache.capacity = capacity;
    return true;
}

void asset_cache_put(const struct asset_key *key, struct image *image)
{
    pthread_mutex_lock(&cache.mutex);
    struct asset_entry *entry = find_entry(key);
    if (entry) {
        drop_entry(entry);
    }
    char *path =
        image_bytes(image) <= cache.budget_bytes && reserve_entry() ? strdup(key->path) : NULL;
    if (path) {
        cache.entries[cache.statistics.entries++] = (struct asset_entry){
            .path = path,
            .path_hash = hash_bytes(HASH_START, path, strlen(path)),
            .stamp = key->stamp,
            .index = key->index,
            .last_use = ++cache.use_counter,
            .image = image_retain(image),
        };
        cache.statistics.bytes += image_bytes(image);
        drop_beyond_budget();
    }
    pthread_mutex_unlock(&cache.mutex);
}

void asset_cache_set_budget(uint64_t bytes)
{
    pthread_mutex_lock(&cache.mutex);
    cache.budget_bytes = bytes;
    drop_beyond_budget();
    if (cache.statistics.entries == 0) {
        free(cache.entries);
        cache.entries = NULL;
        cache.capacity = 0;
    }
    pthread_mutex_unlock(&cache.mutex);
}

struct asset_cache_statistics asset_cache_get_statistics(void)
{
    pthread_mutex_lock(&cache.mutex);
    struct asset_cache_statistics statistics = cache.statistics;
    pthread_mutex_unlock(&cache.mutex);
    return statistics;
}
