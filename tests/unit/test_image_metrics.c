// Proves the error metrics by perturbations whose values follow by hand: constant offsets and
// factors, single bad pixels, known quantiles, and the fixed points of SSIM and FLIP. Files of
// float images are written, read back, and damaged.
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "renderer/metrics/heat_map.h"
#include "renderer/metrics/image_metrics.h"

// Radiance is shown as it is.
static const struct display_params plain = {
    .exposure = 1.0f, .tonemap = TONEMAP_NONE, .gamma = 1.0f};

static struct picture filled(uint32_t width, uint32_t height, float red, float green, float blue)
{
    struct picture picture;
    const float rgb[3] = {red, green, blue};
    assert_true(picture_init(&picture, width, height));
    for (size_t i = 0; i < picture_pixel_count(&picture); i++)
        memcpy(picture.rgb + 3 * i, rgb, sizeof(rgb));
    return picture;
}

static struct picture grey(uint32_t width, uint32_t height, float value)
{
    return filled(width, height, value, value, value);
}

// Smooth shading, hard edges, texture and a bright spot, as in images of scenes.
static struct picture synthetic(void)
{
    struct picture picture;
    assert_true(picture_init(&picture, 160, 90));
    for (uint32_t y = 0; y < picture.height; y++)
        for (uint32_t x = 0; x < picture.width; x++) {
            float *rgb = picture.rgb + 3 * ((size_t)y * picture.width + x);
            float shade = 0.05f + 0.4f * (float)x / 160.0f;
            bool block = x > 60 && x < 110 && y > 40 && y < 80;
            float texture = y > 60 ? 0.5f + 0.5f * (float)((x / 4 + y / 4) % 2) : 1.0f;
            rgb[0] = shade * texture * (block ? 0.3f : 1.0f);
            rgb[1] = shade * texture * (block ? 0.6f : 0.9f);
            rgb[2] = shade * texture * (block ? 1.0f : 0.7f);
            if (x > 140 && y < 10)
                rgb[0] = rgb[1] = rgb[2] = 8.0f;
        }
    return picture;
}

static struct picture scaled(const struct picture *source, float factor)
{
    struct picture picture;
    assert_true(picture_init(&picture, source->width, source->height));
    for (size_t i = 0; i < 3 * picture_pixel_count(source); i++)
        picture.rgb[i] = factor * source->rgb[i];
    return picture;
}

static struct image_metrics measure(const struct picture *test, const struct picture *reference,
                                    const struct display_params *display)
{
    struct image_metrics metrics;
    struct error error = {""};
    if (!image_metrics_compute(test, reference, display, &metrics, NULL, &error))
        fail_msg("%s", error.message);
    return metrics;
}

static void assert_near(double value, double wanted, double tolerance)
{
    if (!(fabs(value - wanted) <= tolerance))
        fail_msg("%.9g is not within %.3g of %.9g", value, tolerance, wanted);
}

static void test_same_pictures(void **state)
{
    (void)state;
    struct picture picture = synthetic();
    struct image_metrics metrics = measure(&picture, &picture, &plain);
    for (int i = 0; i < METRIC_COUNT; i++)
        assert_near(image_metric_error((enum image_metric)i, metrics.values[i]), 0.0, 1e-12);
    assert_true(isinf(metrics.values[METRIC_PSNR]) && metrics.values[METRIC_PSNR] > 0.0);
    assert_near(metrics.values[METRIC_SSIM], 1.0, 1e-12);
    picture_finish(&picture);
}

static void test_constant_offset(void **state)
{
    (void)state;
    struct picture reference = filled(16, 12, 0.5f, 0.25f, 0.125f);
    struct picture test = filled(16, 12, 0.6f, 0.25f, 0.0f);
    struct image_metrics metrics = measure(&test, &reference, &plain);
    const double *values = metrics.values;
    assert_near(values[METRIC_RMSE], sqrt((0.01 + 0.015625) / 3.0), 1e-6);
    assert_near(values[METRIC_MAE], (0.1 + 0.125) / 3.0, 1e-6);
    assert_near(values[METRIC_P95], (0.1 + 0.125) / 3.0, 1e-6);
    // Squared error over 1.01 times the square of the reference image, which is uniform.
    assert_near(values[METRIC_REL_MSE], (0.04 + 1.0) / 1.01 / 3.0, 1e-6);
    assert_near(values[METRIC_ENERGY_RED], 1.2, 1e-6);
    assert_near(values[METRIC_ENERGY_GREEN], 1.0, 1e-6);
    assert_near(values[METRIC_ENERGY_BLUE], 0.0, 1e-6);
    assert_near(values[METRIC_PSNR], -10.0 * log10((0.01 + 0.015625) / 3.0), 1e-5);
    picture_finish(&reference);
    picture_finish(&test);
}

static void test_relative_error_does_not_depend_on_the_unit(void **state)
{
    (void)state;
    struct picture reference = synthetic(), test = scaled(&reference, 1.25f);
    struct picture far_reference = scaled(&reference, 1000.0f), far_test = scaled(&test, 1000.0f);
    double near_error = measure(&test, &reference, &plain).values[METRIC_REL_MSE];
    double far_error = measure(&far_test, &far_reference, &plain).values[METRIC_REL_MSE];
    assert_near(far_error / near_error, 1.0, 1e-5);
    assert_true(near_error < 0.0625 && near_error > 0.01);
    picture_finish(&reference);
    picture_finish(&test);
    picture_finish(&far_reference);
    picture_finish(&far_test);
}

static void test_percentile(void **state)
{
    (void)state;
    // Errors of 1 to 100, one each.
    struct picture reference = grey(10, 10, 0.0f), test = grey(10, 10, 0.0f);
    for (int i = 0; i < 100; i++)
        for (int c = 0; c < 3; c++)
            test.rgb[3 * ((37 * i) % 100) + c] = (float)(i + 1);
    assert_near(measure(&test, &reference, &plain).values[METRIC_P95], 95.0, 0.0);
    picture_finish(&reference);
    picture_finish(&test);
}

static void test_pixels_that_are_not_finite(void **state)
{
    (void)state;
    struct picture reference = grey(10, 10, 0.5f), test = grey(10, 10, 0.6f);
    test.rgb[4] = NAN;
    test.rgb[30] = INFINITY;
    test.rgb[31] = -INFINITY;
    struct image_metrics metrics = measure(&test, &reference, &plain);
    assert_near(metrics.values[METRIC_NOT_FINITE], 0.02, 1e-12);
    assert_near(metrics.values[METRIC_RMSE], 0.1, 1e-6);
    assert_near(metrics.values[METRIC_ENERGY_GREEN], 1.2, 1e-6);
    for (int i = 0; i < METRIC_COUNT; i++)
        assert_true(isfinite(metrics.values[i]));
    // Pixels that are not finite count as black.
    assert_true(metrics.values[METRIC_PSNR] < 20.0);
    for (size_t i = 0; i < 300; i++)
        test.rgb[i] = NAN;
    metrics = measure(&test, &reference, &plain);
    assert_near(metrics.values[METRIC_NOT_FINITE], 1.0, 0.0);
    assert_true(isnan(metrics.values[METRIC_RMSE]));
    picture_finish(&reference);
    picture_finish(&test);
}

static void test_ssim(void **state)
{
    (void)state;
    // For constant images, only the term of means is left.
    struct picture a = grey(32, 20, 0.5f), b = grey(32, 20, 0.7f);
    double wanted = (2.0 * 0.5 * 0.7 + 1e-4) / (0.25 + 0.49 + 1e-4);
    assert_near(measure(&a, &b, &plain).values[METRIC_SSIM], wanted, 1e-6);
    // Smaller than a window.
    struct picture small_a = grey(3, 2, 0.5f), small_b = grey(3, 2, 0.7f);
    assert_near(measure(&small_a, &small_b, &plain).values[METRIC_SSIM], wanted, 1e-6);
    // A pattern and its negative: where a pattern's variance is v, means m and 1 - m, covariance is
    // -v. Stripes of one column in a Gaussian of 1.5 pixels: m is 0.5 but for 0.5 e^(-11), v 0.04.
    for (uint32_t i = 0; i < 32 * 20; i++)
        for (int c = 0; c < 3; c++) {
            a.rgb[3 * i + c] = (i % 32) % 2 ? 0.7f : 0.3f;
            b.rgb[3 * i + c] = (i % 32) % 2 ? 0.3f : 0.7f;
        }
    wanted = (-2.0 * 0.04 + 9e-4) / (2.0 * 0.04 + 9e-4);
    assert_near(measure(&a, &b, &plain).values[METRIC_SSIM], wanted, 1e-3);
    picture_finish(&a);
    picture_finish(&b);
    picture_finish(&small_a);
    picture_finish(&small_b);
}

// The paper's colour error of two greys: HyAB is the difference in lightness, which is raised to
// 0.7; 0.4 of the largest such difference, 41.26 for green and blue, is mapped to 0.95.
static double grey_error(double linear_a, double linear_b)
{
    double lightness_a = 116.0 * cbrt(linear_a) - 16.0, lightness_b = 116.0 * cbrt(linear_b) - 16.0;
    double difference = pow(fabs(lightness_a - lightness_b), 0.7), knee = 0.4 * 41.26;
    return difference < knee ? 0.95 * difference / knee
                             : 0.95 + 0.05 * (difference - knee) / (41.26 - knee);
}

static void test_flip_of_constant_pictures(void **state)
{
    (void)state;
    struct picture black = grey(40, 30, 0.0f), white = grey(40, 30, 1.0f);
    struct picture dark = grey(40, 30, 0.2f), light = grey(40, 30, 0.25f);
    struct display_params srgb = plain;
    srgb.gamma = 0.0f;
    assert_near(measure(&black, &white, &plain).values[METRIC_LDR_FLIP], 0.967, 1e-3);
    assert_near(measure(&white, &black, &plain).values[METRIC_LDR_FLIP], 0.967, 1e-3);
    assert_near(measure(&dark, &light, &srgb).values[METRIC_LDR_FLIP], grey_error(0.2, 0.25), 1e-3);
    // What is a little darker than white: 2 % and 10 % of light.
    struct picture little = grey(40, 30, 1.0f / 1.02f), more = grey(40, 30, 1.0f / 1.1f);
    assert_near(measure(&little, &white, &srgb).values[METRIC_LDR_FLIP], 0.05, 0.005);
    assert_near(measure(&more, &white, &srgb).values[METRIC_LDR_FLIP], 0.145, 0.005);
    // Green and blue differ most of all.
    struct picture green = filled(40, 30, 0.0f, 1.0f, 0.0f),
                   blue = filled(40, 30, 0.0f, 0.0f, 1.0f);
    assert_near(measure(&green, &blue, &plain).values[METRIC_LDR_FLIP], 1.0, 1e-4);
    struct picture *all[] = {&black, &white, &dark, &light, &green, &blue, &little, &more};
    for (int i = 0; i < 8; i++)
        picture_finish(all[i]);
}

static void test_flip_of_a_scene(void **state)
{
    (void)state;
    struct picture reference = synthetic();
    struct picture little = scaled(&reference, 1.02f), more = scaled(&reference, 1.1f);
    struct display_params display = {.exposure = display_automatic_exposure(&reference),
                                     .tonemap = TONEMAP_HABLE};
    double of_little = measure(&little, &reference, &display).values[METRIC_LDR_FLIP];
    double of_more = measure(&more, &reference, &display).values[METRIC_LDR_FLIP];
    double turned = measure(&reference, &more, &display).values[METRIC_LDR_FLIP];
    printf("LDR-FLIP: 2 %% too bright %.4f, 10 %% too bright %.4f\n", of_little, of_more);
    assert_near(of_more, turned, 1e-6);
    // The tone curve takes some of the difference away.
    assert_true(of_little > 0.02 && of_little < 0.05);
    assert_true(of_more > 0.06 && of_more < 0.15);
    picture_finish(&reference);
    picture_finish(&little);
    picture_finish(&more);
}

// The same difference of colour counts for more where it makes a point or an edge.
static void test_flip_amplifies_features(void **state)
{
    (void)state;
    struct picture reference = grey(60, 60, 0.5f), test = grey(60, 60, 0.5f);
    float *map = malloc(60 * 60 * sizeof(float));
    assert_non_null(map);
    for (int y = 28; y < 32; y++)
        for (int x = 28; x < 32; x++)
            for (int c = 0; c < 3; c++)
                test.rgb[3 * (60 * y + x) + c] = 0.6f;
    assert_true(flip_ldr(&test, &reference, FLIP_PIXELS_PER_DEGREE, map));
    struct picture all = grey(60, 60, 0.6f);
    struct image_metrics evenly = measure(&all, &reference, &plain);
    assert_true(map[60 * 30 + 30] > 1.2f * (float)evenly.values[METRIC_LDR_FLIP]);
    assert_true(map[0] < 1e-6f);
    free(map);
    picture_finish(&reference);
    picture_finish(&test);
    picture_finish(&all);
}

static void test_hdr_flip(void **state)
{
    (void)state;
    // A median of 1 and a highest of 16 are four stops apart.
    struct picture reference = grey(20, 20, 1.0f);
    for (int c = 0; c < 3; c++)
        reference.rgb[c] = 16.0f;
    struct flip_exposures exposures = flip_find_exposures(&reference);
    float x = 0.6f * exp2f(exposures.stop_stops);
    assert_near((x * (2.51f * x + 0.03f)) / (x * (2.43f * x + 0.59f) + 0.14f), 0.85, 1e-5);
    assert_near(exposures.stop_stops - exposures.start_stops, 4.0, 1e-5);
    assert_int_equal(exposures.count, 4);
    // A black image has an exposure, too.
    struct picture black = grey(20, 20, 0.0f);
    assert_int_equal(flip_find_exposures(&black).count, 1);
    // The unit of radiance does not matter.
    struct picture scene = synthetic(), brighter = scaled(&scene, 1.1f);
    struct picture far_scene = scaled(&scene, 3000.0f), far_brighter = scaled(&brighter, 3000.0f);
    double near_error = measure(&brighter, &scene, &plain).values[METRIC_HDR_FLIP];
    double far_error = measure(&far_brighter, &far_scene, &plain).values[METRIC_HDR_FLIP];
    printf("HDR-FLIP: 10 %% too bright %.4f\n", near_error);
    assert_near(near_error, far_error, 1e-4);
    assert_true(near_error > 0.08 && near_error < 0.3);
    // It sees what one exposure hides: white beyond white.
    struct picture *bright_spot = &far_brighter;
    memcpy(bright_spot->rgb, scene.rgb, 3 * picture_pixel_count(&scene) * sizeof(float));
    for (uint32_t y = 0; y < 10; y++)
        for (uint32_t column = 141; column < 160; column++)
            for (int c = 0; c < 3; c++)
                bright_spot->rgb[3 * (y * 160 + column) + (uint32_t)c] = 4.0f;
    struct image_metrics metrics = measure(bright_spot, &scene, &plain);
    assert_near(metrics.values[METRIC_LDR_FLIP], 0.0, 1e-6);
    assert_true(metrics.values[METRIC_HDR_FLIP] > 1e-3);
    struct picture *all[] = {&reference, &black, &scene, &brighter, &far_scene, &far_brighter};
    for (int i = 0; i < 6; i++)
        picture_finish(all[i]);
}

static void test_indirect_light_alone(void **state)
{
    (void)state;
    struct picture direct = grey(8, 8, 2.0f), test = grey(8, 8, 2.6f), reference = grey(8, 8, 2.5f);
    struct picture wrong = grey(8, 9, 0.0f);
    struct error error = {""};
    assert_true(picture_subtract(&test, &direct, &error));
    assert_true(picture_subtract(&reference, &direct, &error));
    assert_near(measure(&test, &reference, &plain).values[METRIC_ENERGY_RED], 1.2, 1e-5);
    assert_false(picture_subtract(&test, &wrong, &error));
    assert_non_null(strstr(error.message, "8x8"));
    assert_non_null(strstr(error.message, "8x9"));
    struct image_metrics metrics;
    assert_false(image_metrics_compute(&test, &wrong, &plain, &metrics, NULL, &error));
    struct picture *all[] = {&direct, &test, &reference, &wrong};
    for (int i = 0; i < 4; i++)
        picture_finish(all[i]);
}

static void write_bytes(const char *path, const void *bytes, size_t size)
{
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    assert_int_equal(fclose(file), 0);
}

static void test_files(void **state)
{
    (void)state;
    char path[] = "/tmp/voxcast-picture-XXXXXX";
    int descriptor = mkstemp(path);
    assert_true(descriptor >= 0);
    close(descriptor);
    struct error error = {""};
    struct picture picture = synthetic(), read = {0};
    assert_true(picture_write_pfm(path, &picture, &error));
    assert_true(picture_read_pfm(path, &read, &error));
    assert_int_equal(read.width, 160);
    assert_memory_equal(read.rgb, picture.rgb, 3 * sizeof(float) * picture_pixel_count(&read));
    picture_finish(&read);
    // Big-endian 1.0, 2.0, 0.5; rows from the bottom up.
    static const unsigned char big[] = "PF 1 2 1.0\n"
                                       "\x3f\x80\0\0\x40\0\0\0\x3f\0\0\0"
                                       "\0\0\0\0\0\0\0\0\x3f\x80\0\0";
    write_bytes(path, big, sizeof(big) - 1);
    assert_true(picture_read_pfm(path, &read, &error));
    assert_true(read.rgb[2] == 1.0f && read.rgb[3] == 1.0f && read.rgb[4] == 2.0f);
    picture_finish(&read);
    static const char *const broken[] = {
        "",          "P6 1 1 255\n", "Pf 1 1 -1\n...",  "PF",           "PF 0 1 -1\n",
        "PF 1 1 0 ", "PF 1 1 x\n",   "PF 99999 1 -1\n", "PF -3 1 -1\n", "PF 2 2 -1\n0123456789"};
    for (size_t i = 0; i < sizeof(broken) / sizeof(broken[0]); i++) {
        write_bytes(path, broken[i], strlen(broken[i]));
        if (picture_read_pfm(path, &read, &error))
            fail_msg("\"%s\" was read", broken[i]);
        assert_non_null(strstr(error.message, path));
    }
    remove(path);
    assert_false(picture_read_pfm(path, &read, &error));
    assert_non_null(strstr(error.message, "No such file"));
    picture_finish(&picture);
}

// OKLab lightness of a colour in sRGB bytes.
static double lightness_of(const uint8_t rgb[3])
{
    double linear[3];
    for (int c = 0; c < 3; c++)
        linear[c] = display_linear_from_srgb((float)rgb[c] / 255.0f);
    double l = 0.4122214708 * linear[0] + 0.5363325363 * linear[1] + 0.0514459929 * linear[2];
    double m = 0.2119034982 * linear[0] + 0.6806995451 * linear[1] + 0.1073969566 * linear[2];
    double s = 0.0883024619 * linear[0] + 0.2817188376 * linear[1] + 0.6299787005 * linear[2];
    return 0.2104542553 * cbrt(l) + 0.7936177850 * cbrt(m) - 0.0040720468 * cbrt(s);
}

static void test_heat_map_is_even(void **state)
{
    (void)state;
    uint8_t rgb[3];
    // Below a tenth, bytes are too coarse for the blackest colours.
    for (int i = 10; i <= 100; i++) {
        heat_map_color((float)i / 100.0f, rgb);
        assert_near(lightness_of(rgb), 0.97 * i / 100.0, 0.012);
    }
    heat_map_color(0.0f, rgb);
    assert_true(rgb[0] == 0 && rgb[1] == 0 && rgb[2] == 0);
    const float errors[4] = {-1.0f, 2.0f, NAN, 0.5f};
    uint8_t colors[12], white[3];
    heat_map_colors(errors, 4, colors);
    heat_map_color(1.0f, white);
    assert_memory_equal(colors, rgb, 3);
    assert_memory_equal(colors + 3, white, 3);
    assert_memory_equal(colors + 6, white, 3);
    assert_true(colors[9] > 2 * colors[10]); // red in the middle
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_same_pictures),
        cmocka_unit_test(test_constant_offset),
        cmocka_unit_test(test_relative_error_does_not_depend_on_the_unit),
        cmocka_unit_test(test_percentile),
        cmocka_unit_test(test_pixels_that_are_not_finite),
        cmocka_unit_test(test_ssim),
        cmocka_unit_test(test_flip_of_constant_pictures),
        cmocka_unit_test(test_flip_of_a_scene),
        cmocka_unit_test(test_flip_amplifies_features),
        cmocka_unit_test(test_hdr_flip),
        cmocka_unit_test(test_indirect_light_alone),
        cmocka_unit_test(test_files),
        cmocka_unit_test(test_heat_map_is_even),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
