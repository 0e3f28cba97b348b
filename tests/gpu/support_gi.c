#include "support_gi.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include <cmocka.h>

static uint32_t unconverged_pictures;

const enum gi_method gi_proved_methods[GI_PROVED_METHODS] = {GI_METHOD_CLIPMAP, GI_METHOD_GRID};

bool gi_test_is_full(void)
{
    const char *value = getenv("VOXCAST_TEST_FULL");
    return value && strcmp(value, "0") != 0 && value[0] != '\0';
}

static void print_check(struct gi_report *report, bool good, const char *text)
{
    report->checked++;
    report->bad += !good;
    print_message("  %-3s %s\n", good ? "ok" : "BAD", text);
    fflush(stdout);
}

void gi_check(struct gi_report *report, bool good, const char *format, ...)
{
    char text[512];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof(text), format, arguments);
    va_end(arguments);
    print_check(report, good, text);
}

void gi_check_ratio(struct gi_report *report, double measured, double expected, double tolerance,
                    const char *format, ...)
{
    char name[256], text[512];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(name, sizeof(name), format, arguments);
    va_end(arguments);
    double ratio = measured / expected;
    snprintf(text, sizeof(text), "%s: measured %.6g expected %.6g ratio %.4f (within %g)", name,
             measured, expected, ratio, tolerance);
    print_check(report, fabs(ratio - 1.0) <= tolerance, text);
}

void gi_report_finish(const struct gi_report *report)
{
    print_message("  %u of %u good\n", report->checked - report->bad, report->checked);
    uint32_t unconverged = unconverged_pictures;
    unconverged_pictures = 0;
    if (unconverged > 0)
        fail_msg("%u pictures have not converged after %u frames", unconverged, GI_MAX_FRAMES);
    if (report->bad > 0 || report->checked == 0)
        fail_msg("%u of %u checks are bad; see the lines above", report->bad, report->checked);
}

static void copy_pixels(const struct frame_pixels *pixels, struct test_picture *picture)
{
    size_t row_values = (size_t)pixels->width * 4;
    picture->width = pixels->width;
    picture->height = pixels->height;
    if (!picture->pixels)
        picture->pixels = malloc(row_values * pixels->height * sizeof(float));
    assert_non_null(picture->pixels);
    for (uint32_t y = 0; y < pixels->height; y++) {
        const uint8_t *row = pixels->planes[0] + (size_t)y * pixels->row_pitch_bytes[0];
        float *out = picture->pixels + y * row_values;
        if (pixels->output == FRAME_OUTPUT_LINEAR)
            memcpy(out, row, row_values * sizeof(float));
        for (size_t i = 0; i < row_values && pixels->output == FRAME_OUTPUT_RGBA8; i++)
            out[i] = row[i];
    }
}

enum render_result gi_draw_once(struct renderer *renderer, struct view *view,
                                const struct frame_params *params, struct test_picture *out_picture)
{
    struct error error = {""};
    struct frame_pixels pixels;
    enum render_result result = renderer_view_draw(renderer, view, params, &error);
    if (result == RENDER_DRAWN && !renderer_view_collect(renderer, view, true, &pixels))
        result = RENDER_FAILED;
    if (result == RENDER_FAILED)
        print_error("a frame failed: %s\n", error.message);
    if (result != RENDER_DRAWN)
        return result;
    copy_pixels(&pixels, out_picture);
    renderer_view_release(renderer, view);
    return result;
}

uint32_t gi_converge(struct renderer *renderer, struct view *view,
                     const struct frame_params *params, struct test_picture *out_picture)
{
    for (uint32_t frame = 0; frame < GI_MAX_FRAMES; frame++) {
        enum render_result result = gi_draw_once(renderer, view, params, out_picture);
        if (result != RENDER_DRAWN)
            return result == RENDER_UNCHANGED ? frame : 0;
    }
    unconverged_pictures++;
    print_message("      not converged after %u frames\n", GI_MAX_FRAMES);
    return GI_MAX_FRAMES;
}

static double now_s(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

struct view *gi_show(struct scene *scene)
{
    struct error error = {""};
    if (!renderer_set_scene(test_renderer(), scene, &error))
        fail_msg("%s", error.message);
    struct view *view = renderer_view_create(test_renderer());
    assert_non_null(view);
    return view;
}

struct test_picture gi_draw_in(struct view *view, const struct frame_params *params)
{
    struct test_picture picture = {0};
    double start_s = now_s();
    uint32_t frames = gi_converge(test_renderer(), view, params, &picture);
    if (frames == 0)
        fail_msg("the scene cannot be drawn");
    if (frames > 1)
        print_message("      %u frames in %.1f s\n", frames, now_s() - start_s);
    return picture;
}

void gi_hide(struct view **view)
{
    struct error error;
    renderer_view_destroy(test_renderer(), view);
    renderer_set_scene(test_renderer(), NULL, &error);
}

struct test_picture gi_draw(struct scene *scene, const struct frame_params *params)
{
    struct view *view = gi_show(scene);
    struct test_picture picture = gi_draw_in(view, params);
    gi_hide(&view);
    return picture;
}

void gi_picture_finish(struct test_picture *picture)
{
    free(picture->pixels);
    *picture = (struct test_picture){0};
}

void gi_mean(const float *pixels, uint32_t width, uint32_t height, double out_rgb[3])
{
    size_t count = (size_t)width * height;
    for (size_t c = 0; c < 3; c++) {
        out_rgb[c] = 0.0;
        for (size_t i = 0; i < count; i++)
            out_rgb[c] += pixels[4 * i + c] / (double)count;
    }
}

static int compare_floats(const void *a, const void *b)
{
    float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

double gi_quantile(const struct test_picture *picture, double fraction)
{
    size_t count = (size_t)picture->width * picture->height;
    float *values = malloc(count * sizeof(float));
    assert_non_null(values);
    for (size_t i = 0; i < count; i++)
        values[i] = picture->pixels[4 * i];
    qsort(values, count, sizeof(float), compare_floats);
    double value = values[(size_t)(fraction * (double)(count - 1) + 0.5)];
    free(values);
    return value;
}

struct frame_params gi_params(uint32_t width, uint32_t height, enum gi_method method)
{
    struct frame_params params = test_params(width, height, FRAME_OUTPUT_LINEAR);
    params.quality = QUALITY_INTERACTIVE;
    params.settings.gi_method = method;
    params.settings.soft_shadows = false;
    params.settings.gather_mode = GATHER_CACHE; // the tests judge voxels, not rays
    return params;
}
