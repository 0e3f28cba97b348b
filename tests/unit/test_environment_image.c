// Proves that equirectangular images are read from OpenEXR and Radiance files, or refused with a
// message that names the fault, and that the levels made of them keep all of their light. Small
// files are written byte by byte, and by the library's encoder where they are compressed.
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include <math.h>
#include <openexr.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "renderer/image/environment_image.h"
#include "tests/support/exr_file.h"

#define WIDTH  13
#define HEIGHT 7

// Values that half floats hold exactly, a different one for each texel and component.
static void fill_texels(float *texels)
{
    for (int i = 0; i < WIDTH * HEIGHT * 4; i++)
        texels[i] = (float)i * 0.25f;
    texels[0] = 0x1p-24f; // the smallest half
    texels[4] = 65504.0f; // the largest
}

static struct environment_image *decode(const struct exr_file_params *params, const float *texels,
                                        struct error *error)
{
    size_t size;
    uint8_t *bytes = exr_file_write(params, texels, &size);
    assert_non_null(bytes);
    struct environment_image *image = environment_image_decode(bytes, size, error);
    free(bytes);
    return image;
}

static void check_texels(const struct environment_image *image, const float *texels, bool grey)
{
    assert_int_equal(image->width, WIDTH);
    assert_int_equal(image->height, HEIGHT);
    for (int i = 0; i < WIDTH * HEIGHT; i++)
        for (int c = 0; c < 3; c++)
            assert_float_equal(image->pixels[3 * i + c], texels[4 * i + (grey ? 0 : c)], 0);
}

static void test_scanlines_and_tiles(void **state)
{
    (void)state;
    static const char *const channels[] = {"BGR", "ABGR", "BGRZ", "Y", "AY"};
    float texels[WIDTH * HEIGHT * 4];
    fill_texels(texels);
    for (size_t i = 0; i < sizeof(channels) / sizeof(channels[0]); i++)
        for (int half = 0; half < 2; half++)
            for (uint32_t tile_edge = 0; tile_edge <= 16; tile_edge += 4) {
                struct error error = {""};
                struct exr_file_params params = {.width = WIDTH,
                                                 .height = HEIGHT,
                                                 .channels = channels[i],
                                                 .half = half,
                                                 .tile_edge = tile_edge};
                struct environment_image *image = decode(&params, texels, &error);
                assert_string_equal(error.message, "");
                assert_non_null(image);
                check_texels(image, texels, strchr(channels[i], 'Y') != NULL);
                assert_string_equal(image->warning, "");
                environment_image_release(&image);
                assert_null(image);
            }
}

// The fault of each file, and what its message must name.
static void test_refused_by_name(void **state)
{
    (void)state;
    static const struct {
        struct exr_file_params params;
        const char *message;
    } cases[] = {
        {{.channels = "BG"}, "channels R, G and B, or Y, are needed"},
        {{.channels = "XZ"}, "channels R, G and B, or Y, are needed"},
        {{.channels = "BGR", .pixel_type = 1}, "holds integers"},
        {{.channels = "BGR", .sampling = 2}, "sampl"},
        {{.channels = "BGR", .told_width = 100000, .told_height = 50000}, "100000 x 50000"},
        {{.channels = "BGR", .told_width = 16384, .told_height = 8192}, "512 MiB"},
        {{.channels = "BGR", .display_width = WIDTH + 1}, "display window"},
        {{.channels = "BGR", .cube = true}, "cube map"},
        {{.channels = "BGR", .tile_edge = 5000}, "allowed are 1 to 4096"},
    };
    float texels[WIDTH * HEIGHT * 4];
    fill_texels(texels);
    for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
        struct error error = {""};
        struct exr_file_params params = cases[i].params;
        params.width = WIDTH;
        params.height = HEIGHT;
        assert_null(decode(&params, texels, &error));
        print_message("refused: %s\n", error.message);
        assert_non_null(strstr(error.message, cases[i].message));
        assert_true(strlen(error.message) > 10);
    }
}

static void test_truncated_anywhere(void **state)
{
    (void)state;
    float texels[WIDTH * HEIGHT * 4];
    fill_texels(texels);
    for (uint32_t tile_edge = 0; tile_edge <= 4; tile_edge += 4) {
        struct exr_file_params params = {
            .width = WIDTH, .height = HEIGHT, .channels = "BGR", .tile_edge = tile_edge};
        size_t size;
        uint8_t *bytes = exr_file_write(&params, texels, &size);
        for (size_t length = 0; length < size; length++) {
            struct error error = {""};
            uint8_t *part = malloc(length + 1); // of its own, so that sanitizers see its end
            memcpy(part, bytes, length);
            struct environment_image *image = environment_image_decode(part, length, &error);
            assert_null(image);
            assert_true(strlen(error.message) > 10);
            free(part);
        }
        free(bytes);
    }
}

static void test_wrong_values_are_clamped(void **state)
{
    (void)state;
    float texels[WIDTH * HEIGHT * 4];
    fill_texels(texels);
    texels[4] = NAN;
    texels[9] = INFINITY;
    texels[12] = -INFINITY;
    texels[17] = -1.0f;
    texels[20] = 2e10f;
    struct error error = {""};
    struct exr_file_params params = {.width = WIDTH, .height = HEIGHT, .channels = "BGR"};
    struct environment_image *image = decode(&params, texels, &error);
    assert_non_null(image);
    assert_float_equal(image->pixels[3], 0, 0);
    assert_float_equal(image->pixels[7], ENVIRONMENT_MAX_RADIANCE, 0);
    assert_float_equal(image->pixels[9], 0, 0);
    assert_float_equal(image->pixels[13], 0, 0);
    assert_float_equal(image->pixels[15], ENVIRONMENT_MAX_RADIANCE, 0);
    assert_non_null(strstr(image->warning, "5 of 91 texels"));
    environment_image_release(&image);
}

// Every kind of compression by the library's own encoder; of the lossy ones only a constant.
static void write_compressed(const char *path, exr_compression_t compression, float *texels)
{
    static const char *const names[] = {"R", "G", "B"};
    exr_context_t file;
    int part;
    exr_context_initializer_t params = EXR_DEFAULT_CONTEXT_INITIALIZER;
    assert_int_equal(exr_start_write(&file, path, EXR_WRITE_FILE_DIRECTLY, &params), 0);
    assert_int_equal(exr_add_part(file, "sky", EXR_STORAGE_SCANLINE, &part), 0);
    assert_int_equal(exr_initialize_required_attr_simple(file, 0, WIDTH, HEIGHT, compression), 0);
    for (int c = 0; c < 3; c++)
        assert_int_equal(
            exr_add_channel(file, 0, names[c], EXR_PIXEL_FLOAT, EXR_PERCEPTUALLY_LINEAR, 1, 1), 0);
    assert_int_equal(exr_write_header(file), 0);
    exr_encode_pipeline_t encoder = EXR_ENCODE_PIPELINE_INITIALIZER;
    int32_t lines;
    assert_int_equal(exr_get_scanlines_per_chunk(file, 0, &lines), 0);
    for (int y = 0; y < HEIGHT; y += lines) {
        exr_chunk_info_t batch;
        assert_int_equal(exr_write_scanline_chunk_info(file, 0, y, &batch), 0);
        assert_int_equal(y == 0 ? exr_encoding_initialize(file, 0, &batch, &encoder)
                                : exr_encoding_update(file, 0, &batch, &encoder),
                         0);
        for (int c = 0; c < encoder.channel_count; c++) {
            int component = encoder.channels[c].channel_name[0] == 'R'   ? 0
                            : encoder.channels[c].channel_name[0] == 'G' ? 1
                                                                         : 2;
            encoder.channels[c].user_pixel_stride = 16;
            encoder.channels[c].user_line_stride = 16 * WIDTH;
            encoder.channels[c].encode_from_ptr =
                (const uint8_t *)(texels + 4 * (size_t)y * WIDTH + component);
        }
        if (y == 0)
            assert_int_equal(exr_encoding_choose_default_routines(file, 0, &encoder), 0);
        assert_int_equal(exr_encoding_run(file, 0, &encoder), 0);
    }
    exr_encoding_destroy(file, &encoder);
    assert_int_equal(exr_finish(&file), 0);
}

static void test_compressions(void **state)
{
    (void)state;
    float texels[WIDTH * HEIGHT * 4];
    for (int compression = 0; compression <= EXR_COMPRESSION_B44A; compression++) {
        char path[] = "/tmp/voxcast-environment-XXXXXX";
        struct error error = {""};
        bool exact = compression <= EXR_COMPRESSION_PIZ;
        fill_texels(texels);
        for (int i = 0; i < WIDTH * HEIGHT * 4 && !exact; i++)
            texels[i] = (float)(i % 4) + 1.0f;
        close(mkstemp(path));
        write_compressed(path, (exr_compression_t)compression, texels);
        struct environment_image *image = environment_image_load(path, &error);
        unlink(path);
        print_message("compression %d: %s\n", compression, image ? "read" : error.message);
        assert_non_null(image);
        check_texels(image, texels, false);
        environment_image_release(&image);
    }
}

// A header alone: files that are refused by name need no texels.
static void check_header(exr_storage_t storage, int part_count, exr_compression_t compression,
                         const char *message)
{
    char path[] = "/tmp/voxcast-environment-XXXXXX";
    exr_context_t file;
    exr_context_initializer_t params = EXR_DEFAULT_CONTEXT_INITIALIZER;
    close(mkstemp(path));
    assert_int_equal(exr_start_write(&file, path, EXR_WRITE_FILE_DIRECTLY, &params), 0);
    for (int i = 0; i < part_count; i++) {
        int part;
        assert_int_equal(exr_add_part(file, i == 0 ? "left" : "right", storage, &part), 0);
        assert_int_equal(exr_initialize_required_attr_simple(file, i, WIDTH, HEIGHT, compression),
                         0);
        assert_int_equal(
            exr_add_channel(file, i, "Y", EXR_PIXEL_HALF, EXR_PERCEPTUALLY_LINEAR, 1, 1), 0);
    }
    assert_int_equal(exr_write_header(file), 0);
    struct error error = {""};
    assert_null(environment_image_load(path, &error));
    print_message("refused: %s\n", error.message);
    assert_non_null(strstr(error.message, message));
    exr_finish(&file); // it removes what is not complete
}

static void test_other_files_are_named(void **state)
{
    (void)state;
    check_header(EXR_STORAGE_SCANLINE, 2, EXR_COMPRESSION_ZIP, "multi-part OpenEXR file of 2");
    check_header(EXR_STORAGE_DEEP_SCANLINE, 1, EXR_COMPRESSION_ZIPS, "deep OpenEXR image");
    check_header(EXR_STORAGE_SCANLINE, 1, EXR_COMPRESSION_DWAA, "DWAA");
    check_header(EXR_STORAGE_SCANLINE, 1, EXR_COMPRESSION_DWAB, "DWAB");
}

static void test_radiance_clamps_and_bounds(void **state)
{
    (void)state;
    static const char good[] = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n"
                               "\x40\x80\x20\x81\xff\xff\xff\xff";
    static const char huge[] = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 8192 +X 8192\n";
    struct error error = {""};
    struct environment_image *image =
        environment_image_decode((const uint8_t *)good, sizeof(good) - 1, &error);
    assert_non_null(image);
    assert_float_equal(image->pixels[0], 0.5f, 0);
    assert_float_equal(image->pixels[3], ENVIRONMENT_MAX_RADIANCE, 0); // 2^127
    assert_non_null(strstr(image->warning, "1 of 2 texels"));
    environment_image_release(&image);
    assert_null(environment_image_decode((const uint8_t *)huge, sizeof(huge) - 1, &error));
    assert_non_null(strstr(error.message, "512 MiB"));
    for (size_t length = 0; length < sizeof(good) - 1; length++)
        assert_null(environment_image_decode((const uint8_t *)good, length, &error));
    assert_null(environment_image_decode((const uint8_t *)"", 0, &error));
}

// A line of runs, each component on its own, and one that repeats its first texel; truncated at
// every position; and with empty runs, which must not be read for ever.
static void test_radiance_runs(void **state)
{
    (void)state;
    static const uint8_t runs[] = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 8\n"
                                  "\x02\x02\x00\x08\x88\x40\x04\x01\x02\x03\x04\x84\x05"
                                  "\x88\x20\x88\x81\x40\x80\x20\x81\x01\x01\x01\x07";
    size_t size = sizeof(runs) - 1;
    struct error error = {""};
    struct environment_image *image = environment_image_decode(runs, size, &error);
    assert_string_equal(error.message, "");
    assert_non_null(image);
    for (int x = 0; x < 8; x++) {
        assert_float_equal(image->pixels[3 * x], 0.5f, 0);
        assert_float_equal(image->pixels[3 * x + 1], (x < 4 ? x + 1 : 5) / 128.0f, 0);
        assert_float_equal(image->pixels[3 * (8 + x) + 1], 1.0f, 0);
    }
    environment_image_release(&image);
    for (size_t length = 0; length < size; length++)
        assert_null(environment_image_decode(runs, length, &error));
    uint8_t damaged[sizeof(runs)];
    memcpy(damaged, runs, sizeof(runs));
    memset(damaged + 50, 0, size - 50);
    assert_null(environment_image_decode(damaged, size, &error));
    assert_non_null(strstr(error.message, "damaged at line"));
}

// The mean of an image over the sphere, from its own texels and from each level's.
static double mean_of(const float *pixels, uint32_t width, uint32_t height)
{
    double sum = 0.0;
    for (uint32_t y = 0; y < height; y++) {
        double fraction = (cos(M_PI * y / height) - cos(M_PI * (y + 1) / height)) / 2.0 / width;
        for (uint32_t x = 0; x < width; x++)
            sum += fraction * (double)pixels[3 * ((size_t)y * width + x)];
    }
    return sum;
}

static void test_levels_keep_the_light(void **state)
{
    (void)state;
    static const uint32_t sizes[][2] = {{1, 1}, {2, 1}, {13, 7}, {300, 150}, {1000, 500}, {257, 1}};
    for (size_t s = 0; s < sizeof(sizes) / sizeof(sizes[0]); s++) {
        uint32_t width = sizes[s][0], height = sizes[s][1];
        float *pixels = calloc((size_t)width * height, 3 * sizeof(float));
        assert_non_null(pixels);
        for (uint32_t i = 0; i < width * height; i++)
            pixels[3 * i] = 0.5f;
        pixels[3 * ((size_t)(height / 3) * width + width / 2)] = 1e6f; // a sun
        double mean = mean_of(pixels, width, height), worst = 0.0;
        struct environment_image *image = environment_image_create(width, height, pixels);
        assert_non_null(image);
        for (uint32_t i = 0; i < image->level_count; i++) {
            const struct environment_level *level = &image->levels[i];
            worst =
                fmax(worst, fabs(mean_of(level->pixels, level->width, level->height) / mean - 1));
        }
        const struct environment_level *last = &image->levels[image->level_count - 1];
        assert_int_equal(last->width * last->height, 1);
        print_message("%u x %u: levels are off by %.2g at most\n", width, height, worst);
        assert_true(worst < 1e-5); // 3e-7 measured
        float color[3];
        environment_image_sample(image, (float[3]){0, 1, 0}, 4 * (float)M_PI, color);
        assert_float_equal(color[0] / (float)mean, 1.0f, 1e-4f);
        environment_image_release(&image);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_scanlines_and_tiles),
        cmocka_unit_test(test_refused_by_name),
        cmocka_unit_test(test_truncated_anywhere),
        cmocka_unit_test(test_wrong_values_are_clamped),
        cmocka_unit_test(test_compressions),
        cmocka_unit_test(test_other_files_are_named),
        cmocka_unit_test(test_radiance_clamps_and_bounds),
        cmocka_unit_test(test_radiance_runs),
        cmocka_unit_test(test_levels_keep_the_light),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
