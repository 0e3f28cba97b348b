// Proves that the image cache returns an image only for an unchanged file, evicts the least
// recently used images beyond its budget, and counts references correctly across threads. Uses
// images made in memory under made-up paths, so that no file is read.
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include <pthread.h>
#include <stdlib.h>

#include "renderer/image/image_cache.h"

#define EDGE        16u
#define IMAGE_BYTES (EDGE * EDGE * 4u)

static struct image *make_image(void)
{
    uint8_t *rgba = calloc(EDGE * EDGE, 4);
    assert_non_null(rgba);
    struct image *image = image_create(EDGE, EDGE, rgba);
    assert_non_null(image);
    return image;
}

static struct asset_key make_key(const char *path, uint32_t index)
{
    return (struct asset_key){.path = path, .stamp = {100, 200}, .index = index};
}

static int reset_cache(void **state)
{
    (void)state;
    asset_cache_set_budget(0);
    asset_cache_set_budget(ASSET_CACHE_DEFAULT_BUDGET_BYTES);
    return 0;
}

// Adds a new image and keeps no reference of our own.
static void put_new(const struct asset_key *key)
{
    struct image *image = make_image();
    asset_cache_put(key, image);
    image_release(&image);
}

static bool is_held(const struct asset_key *key)
{
    struct image *image = asset_cache_get(key);
    bool held = image != NULL;
    image_release(&image);
    return held;
}

static void test_returns_the_same_picture(void **state)
{
    (void)state;
    struct asset_key key = make_key("/a.png", 0);
    struct image *image = make_image();
    assert_null(asset_cache_get(&key));
    asset_cache_put(&key, image);
    struct image *found = asset_cache_get(&key);
    assert_ptr_equal(found, image);
    assert_int_equal(image->references, 3); // ours, the cache's and the found one
    image_release(&found);
    image_release(&image);
    assert_true(is_held(&key));
}

static void test_changed_file_or_other_index_misses(void **state)
{
    (void)state;
    struct asset_key key = make_key("/a.png", 0);
    put_new(&key);
    struct asset_key newer = key, larger = key, other = key;
    newer.stamp.modified_ns++;
    larger.stamp.size_bytes++;
    other.index = 1;
    assert_false(is_held(&newer));
    assert_false(is_held(&larger));
    assert_false(is_held(&other));
    assert_true(is_held(&key));
    put_new(&newer); // replaces the old one
    assert_false(is_held(&key));
    assert_int_equal(asset_cache_get_statistics().entries, 1);
    assert_int_equal(asset_cache_get_statistics().bytes, IMAGE_BYTES);
}

static void test_least_recently_used_goes_first(void **state)
{
    (void)state;
    struct asset_key a = make_key("/a", 0), b = make_key("/b", 0), c = make_key("/c", 0);
    asset_cache_set_budget(2 * IMAGE_BYTES);
    put_new(&a);
    put_new(&b);
    assert_true(is_held(&a)); // now b is the oldest
    put_new(&c);
    assert_false(is_held(&b));
    assert_true(is_held(&a));
    assert_true(is_held(&c));
    assert_int_equal(asset_cache_get_statistics().bytes, 2 * IMAGE_BYTES);
    asset_cache_set_budget(IMAGE_BYTES);
    assert_false(is_held(&a));
    assert_true(is_held(&c));
}

static void test_picture_outlives_the_cache(void **state)
{
    (void)state;
    struct asset_key key = make_key("/a", 0);
    put_new(&key);
    struct image *image = asset_cache_get(&key);
    asset_cache_set_budget(0);
    assert_false(is_held(&key));
    assert_int_equal(image->references, 1);
    image->rgba[IMAGE_BYTES - 1] = 1;
    image_release(&image);
}

static void *hammer(void *argument)
{
    for (uint32_t i = 0; i < 2000; i++) {
        struct asset_key key = make_key("/shared", i % 8);
        struct image *image = asset_cache_get(&key);
        if (!image) {
            image = make_image();
            asset_cache_put(&key, image);
        }
        *(uint32_t *)argument += image->width == EDGE;
        image_release(&image);
    }
    return NULL;
}

static void test_threads_use_one(void **state)
{
    (void)state;
    pthread_t threads[4];
    uint32_t sound[4] = {0};
    asset_cache_set_budget(4 * IMAGE_BYTES);
    for (int i = 0; i < 4; i++) {
        assert_int_equal(pthread_create(&threads[i], NULL, hammer, &sound[i]), 0);
    }
    for (int i = 0; i < 4; i++) {
        pthread_join(threads[i], NULL);
        assert_int_equal(sound[i], 2000);
    }
    assert_true(asset_cache_get_statistics().bytes <= 4 * IMAGE_BYTES);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup(test_returns_the_same_picture, reset_cache),
        cmocka_unit_test_setup(test_changed_file_or_other_index_misses, reset_cache),
        cmocka_unit_test_setup(test_least_recently_used_goes_first, reset_cache),
        cmocka_unit_test_setup(test_picture_outlives_the_cache, reset_cache),
        cmocka_unit_test_setup(test_threads_use_one, reset_cache),
    };
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    reset_cache(NULL);
    return failed;
}
