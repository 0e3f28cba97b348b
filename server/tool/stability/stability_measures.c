// Differences between images.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "renderer/metrics/display.h"
#include "renderer/metrics/flip.h"
#include "server/tool/stability/stability.h"

double stability_flip(const struct picture *test, const struct picture *expected)
{
    struct picture shown[2] = {{0}, {0}};
    size_t count = picture_pixel_count(expected);
    float *map = malloc(count * sizeof(float));
    double sum = 0.0;
    struct display_params display = {.exposure = display_automatic_exposure(expected),
                                     .tonemap = TONEMAP_HABLE};
    bool done = map && picture_init(&shown[0], test->width, test->height) &&
                picture_init(&shown[1], expected->width, expected->height);
    if (done) {
        display_picture(&display, test, &shown[0]);
        display_picture(&display, expected, &shown[1]);
        done = flip_ldr(&shown[0], &shown[1], FLIP_PIXELS_PER_DEGREE, map);
    }
    for (size_t i = 0; i < count && done; i++)
        sum += map[i];
    picture_finish(&shown[0]);
    picture_finish(&shown[1]);
    free(map);
    return done ? sum / (double)count : INFINITY;
}

double stability_difference(const struct picture *test, const struct picture *expected,
                            uint32_t *out_pixel)
{
    double brightest = 1e-30, worst = 0.0;
    size_t count = 3 * picture_pixel_count(expected);
    for (size_t i = 0; i < count; i++)
        brightest = fmax(brightest, (double)expected->rgb[i]);
    for (size_t i = 0; i < count; i++) {
        double difference = fabs((double)test->rgb[i] - (double)expected->rgb[i]) / brightest;
        if (difference <= worst)
            continue;
        worst = difference;
        if (out_pixel)
            *out_pixel = (uint32_t)(i / 3);
        if (isnan(difference))
            return INFINITY;
    }
    return worst;
}

void stability_compare(struct stability_run *run, const struct picture *test,
                       const struct picture *expected, const char *what)
{
    uint32_t pixel = 0;
    double difference = stability_difference(test, expected, &pixel);
    stability_measure(run, difference, "%s%spixel %u, %u", what, *what ? ", " : "",
                      pixel % test->width, pixel / test->width);
    stability_keep(run, expected, "expected");
    stability_keep(run, test, "drawn");
}

uint64_t stability_count_changed(const struct picture *a, const struct picture *b)
{
    uint64_t changed = 0;
    for (size_t i = 0; i < 3 * picture_pixel_count(a); i++)
        changed += memcmp(&a->rgb[i], &b->rgb[i], sizeof(float)) != 0;
    return changed;
}

double stability_mean(const struct picture *picture)
{
    double sum = 0.0;
    size_t count = picture_pixel_count(picture);
    for (size_t i = 0; i < count; i++) {
        const float *p = picture->rgb + 3 * i;
        sum += 0.2126 * (double)p[0] + 0.7152 * (double)p[1] + 0.0722 * (double)p[2];
    }
    return sum / (double)count;
}
