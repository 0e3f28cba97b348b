// Proves LDR-FLIP by the paper's formulas, evaluated again, pixel by pixel, in double precision,
// with two-dimensional filters as the paper writes them (Andersson et al. 2020). Images are random
// blocks, and every pixel's error must agree. HDR-FLIP is LDR-FLIP at its exposures.
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#include "renderer/metrics/display.h"
#include "renderer/metrics/flip.h"

#define WIDTH  23
#define HEIGHT 17

// Linear RGB of one image.
typedef double plane[HEIGHT][WIDTH][3];

static const double xyz_from_rgb[3][3] = {{0.41239080, 0.35758434, 0.18048079},
                                          {0.21263901, 0.71516868, 0.07219232},
                                          {0.01933082, 0.11919478, 0.95053215}};
static const double rgb_from_xyz[3][3] = {{3.24096994, -1.53738318, -0.49861076},
                                          {-0.96924364, 1.87596750, 0.04155506},
                                          {0.05563008, -0.20397696, 1.05697151}};

// XYZ over that of white, which is the sum of a row.
static void relative_xyz(const double rgb[3], double out[3])
{
    for (int i = 0; i < 3; i++) {
        const double *row = xyz_from_rgb[i];
        out[i] = (row[0] * rgb[0] + row[1] * rgb[1] + row[2] * rgb[2]) / (row[0] + row[1] + row[2]);
    }
}

static void opponent(const double rgb[3], double out[3])
{
    double xyz[3];
    relative_xyz(rgb, xyz);
    out[0] = 116.0 * xyz[1] - 16.0;
    out[1] = 500.0 * (xyz[0] - xyz[1]);
    out[2] = 200.0 * (xyz[1] - xyz[2]);
}

static void rgb_from_opponent(const double in[3], double out[3])
{
    double y = (in[0] + 16.0) / 116.0;
    double relative[3] = {y + in[1] / 500.0, y, y - in[2] / 200.0}, xyz[3];
    for (int i = 0; i < 3; i++)
        xyz[i] = relative[i] * (xyz_from_rgb[i][0] + xyz_from_rgb[i][1] + xyz_from_rgb[i][2]);
    for (int i = 0; i < 3; i++) {
        const double *row = rgb_from_xyz[i];
        out[i] = fmin(fmax(row[0] * xyz[0] + row[1] * xyz[1] + row[2] * xyz[2], 0.0), 1.0);
    }
}

static void hunt_lab(const double rgb[3], double out[3])
{
    double xyz[3], f[3];
    relative_xyz(rgb, xyz);
    for (int i = 0; i < 3; i++)
        f[i] = xyz[i] > 216.0 / 24389.0 ? cbrt(xyz[i]) : (24389.0 / 27.0 * xyz[i] + 16.0) / 116.0;
    out[0] = 116.0 * f[1] - 16.0;
    out[1] = 0.01 * out[0] * 500.0 * (f[0] - f[1]);
    out[2] = 0.01 * out[0] * 200.0 * (f[1] - f[2]);
}

static double hyab(const double a[3], const double b[3])
{
    return fabs(a[0] - b[0]) + sqrt((a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
}

static const double *pixel_at(plane picture, int x, int y)
{
    x = x < 0 ? 0 : x >= WIDTH ? WIDTH - 1 : x;
    y = y < 0 ? 0 : y >= HEIGHT ? HEIGHT - 1 : y;
    return picture[y][x];
}

// Weight of the contrast sensitivity filter of one opponent channel, not normalised.
static double sensitivity(int channel, double squared_degrees)
{
    static const double a[3][2] = {{1.0, 0.0}, {1.0, 0.0}, {34.1, 13.5}};
    static const double b[3][2] = {{0.0047, 1e-5}, {0.0053, 1e-5}, {0.04, 0.025}};
    double sum = 0.0;
    for (int i = 0; i < 2; i++)
        sum += a[channel][i] * sqrt(M_PI / b[channel][i]) *
               exp(-M_PI * M_PI * squared_degrees / b[channel][i]);
    return sum;
}

static void filtered_lab(plane picture, int x, int y, double pixels_per_degree, double out[3])
{
    int radius = (int)ceil(3.0 * sqrt(0.04 / (2.0 * M_PI * M_PI)) * pixels_per_degree);
    double sums[3] = {0}, weights[3] = {0}, rgb[3];
    for (int j = -radius; j <= radius; j++)
        for (int i = -radius; i <= radius; i++) {
            double channels[3];
            opponent(pixel_at(picture, x + i, y + j), channels);
            for (int c = 0; c < 3; c++) {
                double weight =
                    sensitivity(c, (i * i + j * j) / (pixels_per_degree * pixels_per_degree));
                sums[c] += weight * channels[c];
                weights[c] += weight;
            }
        }
    for (int c = 0; c < 3; c++)
        sums[c] /= weights[c];
    rgb_from_opponent(sums, rgb);
    hunt_lab(rgb, out);
}

// Length of the responses along x and y of the first (edges) or second (points) derivative of a
// Gaussian, whose positive weights sum up to 1 and negative ones to -1.
static double feature(plane picture, int x, int y, double pixels_per_degree, bool point)
{
    double sigma = 0.5 * 0.082 * pixels_per_degree, length = 0.0;
    int radius = (int)ceil(3.0 * sigma);
    for (int axis = 0; axis < 2; axis++) {
        double positive = 0.0, negative = 0.0, of_positive = 0.0, of_negative = 0.0;
        for (int j = -radius; j <= radius; j++)
            for (int i = -radius; i <= radius; i++) {
                int along = axis ? j : i;
                double weight = exp(-(i * i + j * j) / (2.0 * sigma * sigma)), xyz[3];
                weight *= point ? along * along / (sigma * sigma) - 1.0 : -along;
                relative_xyz(pixel_at(picture, x + i, y + j), xyz);
                *(weight > 0.0 ? &positive : &negative) += fabs(weight);
                *(weight > 0.0 ? &of_positive : &of_negative) += fabs(weight) * xyz[1];
            }
        double answer = of_positive / positive - of_negative / negative;
        length += answer * answer;
    }
    return sqrt(length);
}

static double expected_flip(plane test, plane reference, int x, int y, double pixels_per_degree)
{
    static const double green[3] = {0.0, 1.0, 0.0}, blue[3] = {0.0, 0.0, 1.0};
    double a[3], b[3];
    hunt_lab(green, a);
    hunt_lab(blue, b);
    double largest = pow(hyab(a, b), 0.7);
    filtered_lab(test, x, y, pixels_per_degree, a);
    filtered_lab(reference, x, y, pixels_per_degree, b);
    double color = pow(hyab(a, b), 0.7), knee = 0.4 * largest;
    color = color < knee ? 0.95 / knee * color
                         : 0.95 + (color - knee) / (largest - knee) * (1.0 - 0.95);
    double edges = fabs(feature(test, x, y, pixels_per_degree, false) -
                        feature(reference, x, y, pixels_per_degree, false));
    double points = fabs(feature(test, x, y, pixels_per_degree, true) -
                         feature(reference, x, y, pixels_per_degree, true));
    return pow(color, 1.0 - pow(fmax(edges, points) / sqrt(2.0), 0.5));
}

static float random_value(uint32_t *state)
{
    *state = *state * 1664525u + 1013904223u;
    return (float)(*state >> 8) / 16777216.0f;
}

// Blocks of random sRGB values.
static void fill(struct picture *picture, uint32_t seed, uint32_t edge)
{
    float colors[64][3];
    for (int i = 0; i < 64; i++)
        for (int c = 0; c < 3; c++)
            colors[i][c] = random_value(&seed);
    for (uint32_t y = 0; y < HEIGHT; y++)
        for (uint32_t x = 0; x < WIDTH; x++)
            for (uint32_t c = 0; c < 3; c++)
                picture->rgb[3 * (y * WIDTH + x) + c] = colors[(x / edge + 7 * (y / edge)) % 64][c];
}

static void linearize(const struct picture *picture, plane out)
{
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++)
            for (int c = 0; c < 3; c++)
                out[y][x][c] =
                    (double)display_linear_from_srgb(picture->rgb[3 * (y * WIDTH + x) + c]);
}

static void test_every_pixel_agrees(void **state)
{
    (void)state;
    static const float densities[] = {FLIP_PIXELS_PER_DEGREE, 24.0f};
    struct picture pictures[2];
    plane linear[2];
    float map[HEIGHT * WIDTH];
    double worst = 0.0;
    for (int i = 0; i < 2; i++)
        assert_true(picture_init(&pictures[i], WIDTH, HEIGHT));
    for (uint32_t k = 0; k < 4; k++) {
        float density = densities[k % 2];
        fill(&pictures[0], 3 + k, 1 + k);
        fill(&pictures[1], 17 + k, 5 - k);
        for (int i = 0; i < 2; i++)
            linearize(&pictures[i], linear[i]);
        assert_true(flip_ldr(&pictures[0], &pictures[1], density, map));
        for (int y = 0; y < HEIGHT; y++)
            for (int x = 0; x < WIDTH; x++)
                worst =
                    fmax(worst, fabs((double)map[y * WIDTH + x] -
                                     expected_flip(linear[0], linear[1], x, y, (double)density)));
    }
    printf("largest difference %.2g\n", worst);
    assert_true(worst < 1e-4);
    for (int i = 0; i < 2; i++)
        picture_finish(&pictures[i]);
}

// The images at each exposure, by the curve of the paper, compared as displayed images.
static void test_hdr_is_the_largest_of_its_exposures(void **state)
{
    (void)state;
    struct picture radiance[2], shown[2];
    float map[HEIGHT * WIDTH], one[HEIGHT * WIDTH], wanted[HEIGHT * WIDTH] = {0};
    for (int i = 0; i < 2; i++) {
        assert_true(picture_init(&radiance[i], WIDTH, HEIGHT));
        assert_true(picture_init(&shown[i], WIDTH, HEIGHT));
        fill(&radiance[i], 5 + (uint32_t)i, 3);
        for (int k = 0; k < 3 * WIDTH * HEIGHT; k++)
            radiance[i].rgb[k] = expf(6.0f * radiance[i].rgb[k] - 2.0f);
    }
    struct flip_exposures exposures = flip_find_exposures(&radiance[1]);
    assert_true(exposures.count >= 2);
    for (uint32_t e = 0; e < exposures.count; e++) {
        float fraction = (float)e / (float)(exposures.count - 1);
        // The curve gives linear values; the sRGB curve is undone by the comparison.
        struct display_params display = {
            .exposure = exp2f(exposures.start_stops +
                              fraction * (exposures.stop_stops - exposures.start_stops)),
            .tonemap = TONEMAP_ACES};
        for (int i = 0; i < 2; i++)
            display_picture(&display, &radiance[i], &shown[i]);
        assert_true(flip_ldr(&shown[0], &shown[1], FLIP_PIXELS_PER_DEGREE, one));
        for (int k = 0; k < WIDTH * HEIGHT; k++)
            wanted[k] = fmaxf(wanted[k], one[k]);
    }
    assert_true(flip_hdr(&radiance[0], &radiance[1], &exposures, FLIP_PIXELS_PER_DEGREE, map));
    for (int k = 0; k < WIDTH * HEIGHT; k++)
        assert_float_equal(map[k], wanted[k], 1e-3);
    for (int i = 0; i < 2; i++) {
        picture_finish(&radiance[i]);
        picture_finish(&shown[i]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_pixel_agrees),
        cmocka_unit_test(test_hdr_is_the_largest_of_its_exposures),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
