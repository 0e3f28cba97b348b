#include "renderer/image/image_batch.h"

#include <pthread.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "renderer/image/image_decode.h"
#include "renderer/image/image.h"

struct image_batch {
    struct image_request *requests;
    uint32_t count;
    _Atomic uint32_t next;
    _Atomic uint64_t bytes; // decoded bytes of all images
};

static bool reserve_bytes(struct image_batch *batch, uint32_t width, uint32_t height,
                          struct error *out_error)
{
    uint64_t bytes = (uint64_t)width * height * 4;
    if (atomic_fetch_add(&batch->bytes, bytes) + bytes > IMAGES_MAX_BYTES) {
        atomic_fetch_sub(&batch->bytes, bytes);
        return error_set(out_error, "the scene's images exceed %llu MiB together",
                         IMAGES_MAX_BYTES >> 20);
    }
    return true;
}

// Raise it when a decoder accepts other files than before.
#define DECODER_VERSION 1

// Key of the note that these bytes can be decoded: its content is the image's size.
static struct cache_key note_key(const uint8_t *bytes, size_t size)
{
    struct cache_key key = cache_key_start("decodable image", DECODER_VERSION);
    cache_key_add(&key, bytes, size);
    return key;
}

// An image that an earlier run has decoded; its pixels are decoded if anybody asks for them.
static struct image *find_known(const struct cache_key *key, const uint8_t *bytes, size_t size,
                                uint32_t width, uint32_t height)
{
    const uint32_t here[2] = {width, height};
    size_t note_size;
    void *note = scene_cache_read(key, sizeof(here), &note_size);
    bool known = note && note_size == sizeof(here) && memcmp(note, here, sizeof(here)) == 0;
    free(note);
    return known ? image_create_undecoded(width, height, bytes, size) : NULL;
}

static struct image *decode(const uint8_t *bytes, size_t size, uint32_t width, uint32_t height,
                            struct error *out_error)
{
    bool cached = scene_cache_is_open();
    struct cache_key key = {0};
    if (cached) {
        key = note_key(bytes, size);
        struct image *known = find_known(&key, bytes, size, width, height);
        if (known) {
            return known;
        }
    }
    struct image *image = image_decode(bytes, size, out_error);
    if (image) {
        image_keep_file(image, bytes, size);
    }
    if (image && cached) {
        const uint32_t here[2] = {width, height};
        scene_cache_write(&key, here, sizeof(here));
    }
    return image;
}

static void decode_request(struct image_batch *batch, struct image_request *request,
                           const uint8_t *bytes, size_t size)
{
    uint32_t width, height;
    if (!image_decode_size(bytes, size, &width, &height, &request->error) ||
        !reserve_bytes(batch, width, height, &request->error)) {
        return;
    }
    request->image = decode(bytes, size, width, height, &request->error);
    if (request->image && request->key.path) {
        asset_cache_put(&request->key, request->image);
    }
}

static void load_request(struct image_batch *batch, struct image_request *request)
{
    request->image = NULL;
    bool is_file = request->bytes == NULL;
    if (is_file && !asset_read_stamp(request->key.path, &request->key.stamp)) {
        error_set(&request->error, "'%.200s' is not a readable file", request->key.path);
        return;
    }
    struct image *cached = request->key.path ? asset_cache_get(&request->key) : NULL;
    if (cached) {
        if (reserve_bytes(batch, cached->width, cached->height, &request->error)) {
            request->image = cached;
        } else {
            image_release(&cached);
        }
        return;
    }
    if (!is_file) {
        decode_request(batch, request, request->bytes, request->size);
        return;
    }
    uint8_t *bytes;
    size_t size;
    if (asset_read_file(request->key.path, IMAGE_MAX_BYTES, &bytes, &size, &request->key.stamp,
                        &request->error)) {
        decode_request(batch, request, bytes, size);
        free(bytes);
    }
}

static void *batch_thread(void *argument)
{
    struct image_batch *batch = argument;
    for (uint32_t i; (i = atomic_fetch_add(&batch->next, 1)) < batch->count;) {
        load_request(batch, &batch->requests[i]);
    }
    return NULL;
}

void image_batch_load(struct image_request *requests, uint32_t count)
{
    struct image_batch batch = {.requests = requests, .count = count};
    pthread_t threads[IMAGE_BATCH_MAX_THREADS];
    uint32_t thread_count = 0;
    long cores = sysconf(_SC_NPROCESSORS_ONLN);
    // This thread works, too, so it does not matter if fewer helpers can be started.
    while (thread_count + 1 < count && thread_count + 1 < IMAGE_BATCH_MAX_THREADS &&
           (long)thread_count + 1 < cores &&
           pthread_create(&threads[thread_count], NULL, batch_thread, &batch) == 0) {
        thread_count++;
    }
    batch_thread(&batch);
    for (uint32_t i = 0; i < thread_count; i++) {
        pthread_join(threads[i], NULL);
    }
}
