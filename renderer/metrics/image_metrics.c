#include "renderer/metrics/image_metrics.h"

#include <math.h>
#include <stdlib.h>

#define SSIM_RADIUS      5
#define SSIM_SIGMA       1.5
#define SSIM_C1          (0.01 * 0.01) // squares of K1 and K2, for values of 0..1
#define SSIM_C2          (0.03 * 0.03)
#define P95              0.95
#define REL_MSE_FRACTION 0.01
#define CHANNEL_COUNT    3

const struct image_metric_info image_metric_infos[METRIC_COUNT] = {
    [METRIC_RMSE] = {"rmse", "RMSE", "cd/m^2"},
    [METRIC_MAE] = {"mae", "MAE", "cd/m^2"},
    [METRIC_REL_MSE] = {"rel_mse", "relMSE", ""},
    [METRIC_P95] = {"p95", "95th percentile of error", "cd/m^2"},
    [METRIC_ENERGY_RED] = {"energy_red", "energy ratio, red", ""},
    [METRIC_ENERGY_GREEN] = {"energy_green", "energy ratio, green", ""},
    [METRIC_ENERGY_BLUE] = {"energy_blue", "energy ratio, blue", ""},
    [METRIC_HDR_FLIP] = {"hdr_flip", "HDR-FLIP", ""},
    [METRIC_PSNR] = {"psnr", "PSNR", "dB"},
    [METRIC_SSIM] = {"ssim", "SSIM", ""},
    [METRIC_LDR_FLIP] = {"ldr_flip", "LDR-FLIP", ""},
    [METRIC_NOT_FINITE] = {"not_finite", "pixels not finite", ""},
};

static bool pixel_is_finite(const float rgb[3])
{
    return isfinite(rgb[0]) && isfinite(rgb[1]) && isfinite(rgb[2]);
}

static bool sizes_agree(const struct picture *a, const struct picture *b, struct error *out_error)
{
    return (a->width == b->width && a->height == b->height) ||
           error_set(out_error, "the images differ in size: %ux%u and %ux%u", a->width, a->height,
                     b->width, b->height);
}

static int compare_floats(const void *a, const void *b)
{
    float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

// Sums over the pixels that are finite in both images.
struct radiance_sums {
    size_t count;
    double test[CHANNEL_COUNT], reference[CHANNEL_COUNT];
    double reference_squared[CHANNEL_COUNT];
    double squared, absolute;
};

static void sum_radiance(const struct picture *test, const struct picture *reference,
                         struct radiance_sums *sums, float *errors)
{
    size_t pixels = picture_pixel_count(test);
    for (size_t i = 0; i < pixels; i++) {
        const float *a = test->rgb + 3 * i, *b = reference->rgb + 3 * i;
        if (!pixel_is_finite(a) || !pixel_is_finite(b))
            continue;
        double error = 0.0;
        for (int c = 0; c < CHANNEL_COUNT; c++) {
            double difference = (double)a[c] - b[c];
            sums->test[c] += a[c];
            sums->reference[c] += b[c];
            sums->reference_squared[c] += (double)b[c] * b[c];
            sums->squared += difference * difference;
            error += fabs(difference);
        }
        sums->absolute += error;
        errors[sums->count++] = (float)(error / CHANNEL_COUNT);
    }
}

static double relative_error(const struct picture *test, const struct picture *reference,
                             const struct radiance_sums *sums)
{
    double sum = 0.0, floors[CHANNEL_COUNT];
    size_t pixels = picture_pixel_count(test);
    for (int c = 0; c < CHANNEL_COUNT; c++)
        floors[c] = REL_MSE_FRACTION * sums->reference_squared[c] / (double)sums->count;
    for (size_t i = 0; i < pixels; i++) {
        const float *a = test->rgb + 3 * i, *b = reference->rgb + 3 * i;
        if (!pixel_is_finite(a) || !pixel_is_finite(b))
            continue;
        for (int c = 0; c < CHANNEL_COUNT; c++) {
            double difference = (double)a[c] - b[c];
            if (difference != 0.0)
                sum += difference * difference / ((double)b[c] * b[c] + floors[c]);
        }
    }
    return sum / (double)(CHANNEL_COUNT * sums->count);
}

// Computes the radiance metrics except FLIP. False when out of memory.
static bool measure_radiance(const struct picture *test, const struct picture *reference,
                             double values[METRIC_COUNT])
{
    struct radiance_sums sums = {0};
    float *errors = malloc(picture_pixel_count(test) * sizeof(float));
    if (!errors)
        return false;
    sum_radiance(test, reference, &sums, errors);
    double samples = (double)(CHANNEL_COUNT * sums.count);
    values[METRIC_RMSE] = sqrt(sums.squared / samples);
    values[METRIC_MAE] = sums.absolute / samples;
    values[METRIC_REL_MSE] = relative_error(test, reference, &sums);
    for (int c = 0; c < CHANNEL_COUNT; c++)
        values[METRIC_ENERGY_RED + c] = sums.test[c] / sums.reference[c];
    qsort(errors, sums.count, sizeof(float), compare_floats);
    // Nearest rank: the smallest error that at least 95 % of the pixels do not exceed.
    double rank = ceil(P95 * (double)sums.count);
    values[METRIC_P95] = sums.count > 0 ? errors[(size_t)rank - 1] : NAN;
    free(errors);
    return true;
}

static double not_finite_fraction(const struct picture *picture)
{
    size_t pixels = picture_pixel_count(picture), bad = 0;
    for (size_t i = 0; i < pixels; i++)
        bad += !pixel_is_finite(picture->rgb + 3 * i);
    return (double)bad / (double)pixels;
}

static double luma(const struct picture *picture, size_t pixel)
{
    const float *rgb = picture->rgb + 3 * pixel;
    return 0.299 * rgb[0] + 0.587 * rgb[1] + 0.114 * rgb[2];
}

// Weighted means of x, y, xx, yy, xy over windows.
#define MOMENT_COUNT 5

static void window_weights(double weights[2 * SSIM_RADIUS + 1])
{
    double sum = 0.0;
    for (int i = -SSIM_RADIUS; i <= SSIM_RADIUS; i++) {
        weights[i + SSIM_RADIUS] = exp(-0.5 * i * i / (SSIM_SIGMA * SSIM_SIGMA));
        sum += weights[i + SSIM_RADIUS];
    }
    for (int i = 0; i <= 2 * SSIM_RADIUS; i++)
        weights[i] /= sum;
}

// Moments of the row windows around column `x`; repeats edge pixels.
static void row_moments(const struct picture *a, const struct picture *b, const double *weights,
                        int x, int y, double out[MOMENT_COUNT])
{
    for (int m = 0; m < MOMENT_COUNT; m++)
        out[m] = 0.0;
    for (int i = -SSIM_RADIUS; i <= SSIM_RADIUS; i++) {
        int at = x + i < 0 ? 0 : x + i >= (int)a->width ? (int)a->width - 1 : x + i;
        size_t pixel = (size_t)y * a->width + (size_t)at;
        double weight = weights[i + SSIM_RADIUS], va = luma(a, pixel), vb = luma(b, pixel);
        out[0] += weight * va;
        out[1] += weight * vb;
        out[2] += weight * va * va;
        out[3] += weight * vb * vb;
        out[4] += weight * va * vb;
    }
}

static double window_similarity(const double *rows, int width, int height, const double *weights,
                                int x, int y)
{
    double m[MOMENT_COUNT] = {0};
    for (int i = -SSIM_RADIUS; i <= SSIM_RADIUS; i++) {
        int at = y + i < 0 ? 0 : y + i >= height ? height - 1 : y + i;
        const double *from = rows + ((size_t)at * (size_t)width + (size_t)x) * MOMENT_COUNT;
        for (int k = 0; k < MOMENT_COUNT; k++)
            m[k] += weights[i + SSIM_RADIUS] * from[k];
    }
    double variance_a = m[2] - m[0] * m[0], variance_b = m[3] - m[1] * m[1];
    double covariance = m[4] - m[0] * m[1];
    return (2.0 * m[0] * m[1] + SSIM_C1) * (2.0 * covariance + SSIM_C2) /
           ((m[0] * m[0] + m[1] * m[1] + SSIM_C1) * (variance_a + variance_b + SSIM_C2));
}

// Mean over the windows inside the image, or over all if none is. NaN when out of memory.
static double structural_similarity(const struct picture *a, const struct picture *b)
{
    int width = (int)a->width, height = (int)a->height;
    double weights[2 * SSIM_RADIUS + 1], sum = 0.0;
    double *rows = malloc(picture_pixel_count(a) * MOMENT_COUNT * sizeof(double));
    if (!rows)
        return NAN;
    window_weights(weights);
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++)
            row_moments(a, b, weights, x, y,
                        rows + ((size_t)y * a->width + (size_t)x) * MOMENT_COUNT);
    int margin = width > 2 * SSIM_RADIUS && height > 2 * SSIM_RADIUS ? SSIM_RADIUS : 0;
    for (int y = margin; y < height - margin; y++)
        for (int x = margin; x < width - margin; x++)
            sum += window_similarity(rows, width, height, weights, x, y);
    free(rows);
    return sum / ((double)(width - 2 * margin) * (height - 2 * margin));
}

static double peak_signal_to_noise(const struct picture *a, const struct picture *b)
{
    size_t count = CHANNEL_COUNT * picture_pixel_count(a);
    double squared = 0.0;
    for (size_t i = 0; i < count; i++)
        squared += ((double)a->rgb[i] - b->rgb[i]) * ((double)a->rgb[i] - b->rgb[i]);
    return -10.0 * log10(squared / (double)count); // infinite if nothing differs
}

static double mean(const float *values, size_t count)
{
    double sum = 0.0;
    for (size_t i = 0; i < count; i++)
        sum += values[i];
    return sum / (double)count;
}

// Displayed images and an error map.
struct displayed {
    struct picture test, reference;
    float *map;
};

static bool measure_displayed(const struct picture *test, const struct picture *reference,
                              const struct display_params *display, struct displayed *work,
                              double values[METRIC_COUNT])
{
    struct flip_exposures exposures = flip_find_exposures(reference);
    size_t count = picture_pixel_count(reference);
    if (!flip_hdr(test, reference, &exposures, FLIP_PIXELS_PER_DEGREE, work->map))
        return false;
    values[METRIC_HDR_FLIP] = mean(work->map, count);
    display_picture(display, test, &work->test);
    display_picture(display, reference, &work->reference);
    values[METRIC_PSNR] = peak_signal_to_noise(&work->test, &work->reference);
    values[METRIC_SSIM] = structural_similarity(&work->test, &work->reference);
    if (!flip_ldr(&work->test, &work->reference, FLIP_PIXELS_PER_DEGREE, work->map))
        return false;
    values[METRIC_LDR_FLIP] = mean(work->map, count);
    return !isnan(values[METRIC_SSIM]);
}

bool image_metrics_compute(const struct picture *test, const struct picture *reference,
                           const struct display_params *display, struct image_metrics *out_metrics,
                           float *flip_map, struct error *out_error)
{
    if (!sizes_agree(test, reference, out_error))
        return false;
    struct image_metrics metrics;
    struct displayed work = {0};
    size_t count = picture_pixel_count(reference);
    work.map = flip_map ? flip_map : malloc(count * sizeof(float));
    bool done = work.map && picture_init(&work.test, test->width, test->height) &&
                picture_init(&work.reference, test->width, test->height) &&
                measure_radiance(test, reference, metrics.values) &&
                measure_displayed(test, reference, display, &work, metrics.values);
    if (done) {
        metrics.values[METRIC_NOT_FINITE] = not_finite_fraction(test);
        *out_metrics = metrics;
    }
    picture_finish(&work.test);
    picture_finish(&work.reference);
    if (!flip_map)
        free(work.map);
    return done || error_set(out_error, "out of memory");
}

double image_metric_error(enum image_metric metric, double value)
{
    switch (metric) {
    case METRIC_ENERGY_RED:
    case METRIC_ENERGY_GREEN:
    case METRIC_ENERGY_BLUE:
        return fabs(value - 1.0);
    case METRIC_SSIM:
        return 1.0 - value;
    case METRIC_PSNR:
        return pow(10.0, -value / 20.0);
    default:
        return value;
    }
}

bool picture_subtract(struct picture *picture, const struct picture *part, struct error *out_error)
{
    if (!sizes_agree(picture, part, out_error))
        return false;
    size_t count = CHANNEL_COUNT * picture_pixel_count(picture);
    for (size_t i = 0; i < count; i++)
        picture->rgb[i] -= part->rgb[i];
    return true;
}
