// Proves that pixels of an image are there while it is pinned and go when nobody needs them, that
// they are the same each time, and that many threads may pin at once. Uses a small image made here.
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "renderer/image/image_decode.h"

#define EDGE    64u
#define THREADS 4u

// Run lengths of 128 texels, each run of a colour of its own.
static size_t make_tga(uint8_t bytes[1024])
{
    const uint8_t header[18] = {[2] = 10, [12] = EDGE, [14] = EDGE, [16] = 24, [17] = 0x20};
    memcpy(bytes, header, sizeof(header));
    size_t size = sizeof(header);
    for (uint32_t run = 0; run < EDGE * EDGE / 128; run++) {
        const uint8_t packet[4] = {0xff, (uint8_t)(run * 8), (uint8_t)(255 - run), (uint8_t)run};
        memcpy(bytes + size, packet, sizeof(packet));
        size += sizeof(packet);
    }
    return size;
}

static struct image *make_image(void)
{
    uint8_t bytes[1024];
    size_t size = make_tga(bytes);
    struct image *image = image_decode(bytes, size, NULL);
    assert_non_null(image);
    image_keep_file(image, bytes, size);
    assert_non_null(image->file);
    return image;
}

static void test_pixels_go_and_come_back(void **state)
{
    (void)state;
    struct image *image = make_image();
    assert_true(image_pin(image));
    assert_true(image_pin(image));
    uint8_t *before = malloc(EDGE * EDGE * 4);
    assert_non_null(before);
    memcpy(before, image->rgba, EDGE * EDGE * 4);
    image_unpin(image);
    assert_non_null(image->rgba);
    image_unpin(image);
    assert_null(image->rgba);
    assert_true(image_pin(image));
    assert_memory_equal(image->rgba, before, EDGE * EDGE * 4);
    image_unpin(image);
    image_release(&image);
    free(before);
}

static void test_pixels_without_a_file_stay(void **state)
{
    (void)state;
    uint8_t *rgba = calloc(EDGE * EDGE, 4);
    struct image *image = image_create(EDGE, EDGE, rgba);
    assert_non_null(image);
    uint8_t large[EDGE * EDGE * 3] = {0};
    image_keep_file(image, large, sizeof(large)); // more than half of the pixels: not worth it
    assert_true(image_pin(image));
    image_unpin(image);
    assert_ptr_equal(image->rgba, rgba);
    image_release(&image);
}

static void test_undecoded_images(void **state)
{
    (void)state;
    uint8_t bytes[1024];
    size_t size = make_tga(bytes);
    struct image *image = image_create_undecoded(EDGE, EDGE, bytes, size);
    assert_non_null(image);
    assert_null(image->rgba);
    assert_true(image_pin(image));
    assert_int_equal(image->rgba[0], 0); // red of the first run
    assert_int_equal(image->rgba[1], 255);
    image_unpin(image);
    image_release(&image);
    // What is no image, or one of another size, cannot be pinned.
    image = image_create_undecoded(EDGE, EDGE, bytes, 10);
    assert_non_null(image);
    assert_false(image_pin(image));
    image_release(&image);
    image = image_create_undecoded(EDGE, EDGE / 2, bytes, size);
    assert_non_null(image);
    assert_false(image_pin(image));
    image_release(&image);
}

static void *pin_often(void *argument)
{
    struct image *image = argument;
    uint64_t wrong = 0;
    for (uint32_t i = 0; i < 300; i++) {
        if (!image_pin(image))
            return image;
        wrong += image->rgba[4 * 128 * 5 + 1] != 250;
        image_unpin(image);
    }
    return wrong ? image : NULL;
}

static void test_threads_pin_at_once(void **state)
{
    (void)state;
    struct image *image = make_image();
    pthread_t threads[THREADS];
    for (uint32_t i = 0; i < THREADS; i++)
        assert_int_equal(pthread_create(&threads[i], NULL, pin_often, image), 0);
    for (uint32_t i = 0; i < THREADS; i++) {
        void *failed;
        pthread_join(threads[i], &failed);
        assert_null(failed);
    }
    assert_null(image->rgba);
    image_release(&image);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_pixels_go_and_come_back),
        cmocka_unit_test(test_pixels_without_a_file_stay),
        cmocka_unit_test(test_undecoded_images),
        cmocka_unit_test(test_threads_pin_at_once),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
