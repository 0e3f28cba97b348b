// Proves that image files are decoded with limits checked before decoding, and that Radiance files
// become environments of linear floats. Tiny images are written here byte by byte.
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "renderer/image/image_decode.h"
#include "renderer/import/scene_load.h"

static const char RADIANCE_HEADER[] = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n";

// Two pixels: (0.5, 1, 0.25) and (2, 4, 1).
static const uint8_t RADIANCE_PIXELS[8] = {64, 128, 32, 129, 64, 128, 32, 131};

static void write_temporary(char *path, const void *head, size_t head_size, const void *body,
                            size_t body_size)
{
    int file = mkstemp(path);
    assert_true(file >= 0);
    assert_int_equal(write(file, head, head_size), head_size);
    assert_int_equal(write(file, body, body_size), body_size);
    close(file);
}

static void test_radiance_environment(void **state)
{
    (void)state;
    static const float EXPECTED[6] = {0.5f, 1, 0.25f, 2, 4, 1};
    char path[] = "/tmp/voxcast-radiance-XXXXXX";
    struct scene_environment environment = {0};
    struct error error;
    write_temporary(path, RADIANCE_HEADER, strlen(RADIANCE_HEADER), RADIANCE_PIXELS,
                    sizeof(RADIANCE_PIXELS));
    assert_true(scene_load_environment(path, &environment, &error));
    unlink(path);
    assert_int_equal(environment.type, SCENE_ENVIRONMENT_EQUIRECT);
    assert_int_equal(environment.image->width, 2);
    assert_int_equal(environment.image->height, 1);
    for (int i = 0; i < 6; i++) {
        assert_float_equal(environment.image->pixels[i], EXPECTED[i], 0);
    }
    environment_image_release(&environment.image);
}

static void test_other_files_leave_the_environment(void **state)
{
    (void)state;
    char path[] = "/tmp/voxcast-radiance-XXXXXX";
    struct scene_environment environment = {.type = SCENE_ENVIRONMENT_CONSTANT, .intensity = 3};
    struct error error = {{0}};
    write_temporary(path, "not a ", 6, "picture", 7);
    assert_false(scene_load_environment(path, &environment, &error));
    assert_non_null(strstr(error.message, "Radiance"));
    unlink(path);
    assert_false(scene_load_environment(path, &environment, &error)); // gone
    assert_int_equal(environment.type, SCENE_ENVIRONMENT_CONSTANT);
    assert_float_equal(environment.intensity, 3, 0);
    assert_null(environment.image);
}

// A BMP header of the given size with no pixels behind it.
static bool is_size_allowed(uint32_t width, uint32_t height, struct error *out_error)
{
    uint8_t bytes[64] = {'B', 'M', [10] = 54, [14] = 40, [26] = 1, [28] = 24};
    memcpy(bytes + 18, &width, 4);
    memcpy(bytes + 22, &height, 4);
    uint32_t got_width = 0, got_height = 0;
    bool allowed = image_decode_size(bytes, sizeof(bytes), &got_width, &got_height, out_error);
    return allowed && got_width == width && got_height == height;
}

static void test_limits_hold_before_decoding(void **state)
{
    (void)state;
    struct error error;
    assert_true(is_size_allowed(16, 9, &error));
    assert_true(is_size_allowed(8192, 8192, &error));
    assert_false(is_size_allowed(8193, 8192, &error)); // over 256 MiB decoded
    assert_non_null(strstr(error.message, "8193 x 8192"));
    assert_false(is_size_allowed(IMAGE_MAX_EDGE + 1, 1, &error));
    assert_false(is_size_allowed(0, 1, &error));
}

static void test_pixels_and_damage(void **state)
{
    (void)state;
    // TGA of 2 x 1 pixels in BGRA, rows from the top.
    uint8_t bytes[18 + 8] = {[2] = 2, [12] = 2, [14] = 1, [16] = 32, [17] = 0x28};
    memcpy(bytes + 18, (uint8_t[8]){3, 2, 1, 4, 7, 6, 5, 8}, 8);
    struct error error = {{0}};
    struct image *image = image_decode(bytes, sizeof(bytes), &error);
    assert_non_null(image);
    assert_int_equal(image->width, 2);
    assert_memory_equal(image->rgba, ((uint8_t[8]){1, 2, 3, 4, 5, 6, 7, 8}), 8);
    image_release(&image);
    assert_null(image);
    assert_null(image_decode((const uint8_t *)"\x89PNG\r\n\x1a\n", 8, &error));
    assert_true(strlen(error.message) > 10);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_radiance_environment),
        cmocka_unit_test(test_other_files_leave_the_environment),
        cmocka_unit_test(test_limits_hold_before_decoding),
        cmocka_unit_test(test_pixels_and_damage),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
