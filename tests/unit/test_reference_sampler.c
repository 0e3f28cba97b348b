// Proves the random numbers of the reference path tracer: uniform, and independent from use to use
// and from pixel to pixel. They are stratified as Sobol's first two dimensions are: of 2^m
// consecutive points, one lies in every elementary interval of area 2^-m, whatever its shape.
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include <math.h>
#include <string.h>

#include "renderer/path_tracer/sampler_batch.h"

#define LOG2_POINTS 8u
#define POINTS      (1u << LOG2_POINTS)

static void test_every_elementary_interval_holds_one_point(void **state)
{
    (void)state;
    for (uint32_t use = 0; use < 20; use++)
        for (uint32_t block = 0; block < 3; block++)
            for (uint32_t log2_columns = 0; log2_columns <= LOG2_POINTS; log2_columns++) {
                uint8_t hits[POINTS] = {0};
                uint32_t columns = 1u << log2_columns, rows = POINTS / columns;
                for (uint32_t i = 0; i < POINTS; i++) {
                    struct sampler sampler;
                    float u[2];
                    sampler_init(&sampler, 5, use * 7, block, block * POINTS + i);
                    sampler_get_2d(&sampler, use, u);
                    assert_true(u[0] >= 0.0f && u[0] < 1.0f && u[1] >= 0.0f && u[1] < 1.0f);
                    uint32_t column = (uint32_t)(u[0] * (float)columns);
                    uint32_t row = (uint32_t)(u[1] * (float)rows);
                    hits[row * columns + column]++;
                }
                for (uint32_t i = 0; i < POINTS; i++)
                    assert_int_equal(hits[i], 1);
            }
}

static void test_single_numbers_are_stratified(void **state)
{
    (void)state;
    uint8_t hits[POINTS] = {0};
    for (uint32_t i = 0; i < POINTS; i++) {
        struct sampler sampler;
        sampler_init(&sampler, 1, 2, 3, i);
        hits[(uint32_t)(sampler_get_1d(&sampler, 4) * (float)POINTS)]++;
    }
    for (uint32_t i = 0; i < POINTS; i++)
        assert_int_equal(hits[i], 1);
}

// Correlation between two uses, pixels, sequences or seeds, over many samples: none is beyond what
// chance allows (its standard deviation is 1 / sqrt(n); five of them are allowed).
static void test_uses_and_pixels_are_independent(void **state)
{
    (void)state;
    const uint32_t count = 20000;
    double sums[4] = {0};
    for (uint32_t i = 0; i < count; i++) {
        struct sampler here, other_pixel, other_sequence, other_seed;
        uint32_t pixel = i / 4, index = i % 4;
        sampler_init(&here, 9, pixel, 0, index);
        sampler_init(&other_pixel, 9, pixel + 1, 0, index);
        sampler_init(&other_sequence, 9, pixel, 1, index);
        sampler_init(&other_seed, 10, pixel, 0, index);
        float u[2];
        sampler_get_2d(&here, 3, u);
        double a = u[0] - 0.5;
        sums[0] += a * (sampler_get_1d(&here, 4) - 0.5);
        sums[1] += a * (sampler_get_1d(&other_pixel, 3) - 0.5);
        sums[2] += a * (sampler_get_1d(&other_sequence, 3) - 0.5);
        sums[3] += a * (sampler_get_1d(&other_seed, 3) - 0.5);
    }
    for (int i = 0; i < 4; i++)
        assert_true(fabs(sums[i] / count * 12.0) < 5.0 / sqrt((double)count));
}

// The mean of a smooth function by n points is far nearer to its integral than by n random ones.
static void test_points_integrate_better_than_chance(void **state)
{
    (void)state;
    const uint32_t count = 1024, pixels = 64;
    double squared = 0.0;
    for (uint32_t pixel = 0; pixel < pixels; pixel++) {
        double sum = 0.0;
        for (uint32_t i = 0; i < count; i++) {
            struct sampler sampler;
            float u[2];
            sampler_init(&sampler, 0, pixel, 0, i);
            sampler_get_2d(&sampler, 0, u);
            sum += u[0] * u[0] * u[1];
        }
        double error = sum / count - 1.0 / 6.0;
        squared += error * error / pixels;
    }
    // By chance: sqrt((1/5 1/3 - 1/36) / 1024) = 0.0062.
    print_message("root mean square error %.2g, by chance 0.0062\n", sqrt(squared));
    assert_true(sqrt(squared) < 0.0062 / 20.0);
}

static void test_many_at_once_are_the_same_numbers(void **state)
{
    (void)state;
    for (uint32_t count = 1; count <= SAMPLER_BATCH_SIZE; count++) {
        struct sampler samplers[SAMPLER_BATCH_SIZE];
        struct sampler_batch batch = {0};
        struct sampler_numbers numbers;
        for (uint32_t i = 0; i < count; i++) {
            sampler_init(&samplers[i], 7, 1000 * i, i & 1u, 100 + i * count);
            sampler_batch_set(&batch, i, &samplers[i], 3 * i);
        }
        sampler_batch_get_2d(&batch, count, &numbers);
        for (uint32_t i = 0; i < count; i++) {
            float u[2];
            sampler_get_2d(&samplers[i], 3 * i, u);
            assert_true(numbers.u[0][i] == u[0] && numbers.u[1][i] == u[1]);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_elementary_interval_holds_one_point),
        cmocka_unit_test(test_single_numbers_are_stratified),
        cmocka_unit_test(test_uses_and_pixels_are_independent),
        cmocka_unit_test(test_points_integrate_better_than_chance),
        cmocka_unit_test(test_many_at_once_are_the_same_numbers),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
