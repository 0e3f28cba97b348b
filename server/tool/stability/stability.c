// Runs cases: renderer, frames, images, and what is measured of them.
#include "renderer/metrics/display.h"
#include "renderer/metrics/picture.h"
#include "server/accuracy/picture_file.h"
#include "server/tool/stability/stability_internal.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "renderer/path_tracer/snapshot.h"
#include "server/tool/cli.h"

#define MAX_FRAMES 400u
// Samples of a reference, per pixel: the same in each image, so that only the scenes differ.
#define REFERENCE_SAMPLES 16u

double stability_bound(const struct stability_run *run)
{
    const struct stability_case *test = run->test;
    double bound = 0.0;
    if ((STABILITY_VOXELS & 1u << run->method) != 0)
        bound = test->voxel_bound;
    else if (run->method == GI_METHOD_REFERENCE)
        bound = test->reference_bound;
    return bound > 0.0 ? bound : test->bound;
}

void stability_measure(struct stability_run *run, double value, const char *format, ...)
{
    if (isnan(value))
        value = INFINITY;
    if (run->measured_any && value <= run->measured)
        return;
    run->measured_any = true;
    run->measured = value;
    if (run->failed)
        return;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(run->where, sizeof(run->where), format, arguments);
    va_end(arguments);
}

void stability_fail(struct stability_run *run, const char *format, ...)
{
    if (run->failed)
        return;
    run->failed = true;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(run->where, sizeof(run->where), format, arguments);
    va_end(arguments);
}

struct renderer *stability_renderer(struct stability_run *run)
{
    struct stability *suite = run->suite;
    struct error error = {""};
    if (!suite->renderer)
        suite->renderer = renderer_create(&(struct renderer_params){.gpu = suite->gpu}, &error);
    if (!suite->renderer)
        stability_fail(run, "no renderer: %s", error.message);
    return suite->renderer;
}

void stability_end_renderer(struct stability *suite)
{
    if (suite->renderer)
        renderer_destroy(&suite->renderer);
}

void stability_renew(struct stability_run *run)
{
    stability_end_renderer(run->suite);
}

struct frame_params stability_params(const struct stability_run *run)
{
    struct frame_params params = {.width = STABILITY_WIDTH,
                                  .height = STABILITY_HEIGHT,
                                  .quality = QUALITY_INTERACTIVE,
                                  .output = FRAME_OUTPUT_LINEAR};
    render_settings_init(&params.settings);
    params.settings.gi_method = run->method;
    params.settings.voxel_resolution = VOXEL_RESOLUTION_64;
    params.settings.gather_mode = GATHER_CACHE;
    params.settings.cone_set = CONE_SET_5;
    params.settings.bounces = 2;
    params.settings.clip_levels = 2;
    params.settings.soft_shadows = false;
    params.settings.exposure_mode = EXPOSURE_FIXED;
    params.settings.tonemap = TONEMAP_NONE;
    params.camera.up[1] = 1.0f;
    params.camera.fov_y_rad = 0.9f;
    return params;
}

bool stability_view_open(struct stability_view *view, struct stability_run *run,
                         struct scene *scene)
{
    *view = (struct stability_view){.run = run};
    struct error error = {""};
    struct renderer *renderer = stability_renderer(run);
    if (!renderer)
        return false;
    if (!renderer_set_scene(renderer, scene, &error)) {
        stability_fail(run, "%s", error.message);
        return false;
    }
    view->view = renderer_view_create(renderer);
    if (!view->view)
        stability_fail(run, "no view");
    return view->view != NULL;
}

void stability_view_close(struct stability_view *view)
{
    struct error error;
    struct renderer *renderer = view->run->suite->renderer;
    if (view->view)
        renderer_view_destroy(renderer, &view->view);
    if (renderer) {
        renderer_set_scene(renderer, NULL, &error);
        uint64_t errors = renderer_gl_error_count(renderer);
        if (errors > view->run->suite->gl_errors)
            stability_fail(view->run, "GL reported %llu errors",
                           (unsigned long long)(errors - view->run->suite->gl_errors));
        view->run->suite->gl_errors = errors;
    }
    picture_finish(&view->picture);
}

// Fails the run if any value is not finite.
static void check_finite(struct stability_view *view)
{
    struct stability_run *run = view->run;
    struct finite_report report;
    struct error error = {""};
    if (!renderer_check_finite(run->suite->renderer, view->view, &report, &error))
        stability_fail(run, "the finite check: %s", error.message);
    for (uint32_t i = 0; i < report.count; i++) {
        const struct finite_resource *resource = &report.resources[i];
        run->bad_values += resource->values;
        if (resource->values > 0)
            stability_fail(run, "frame %u: %u values of %s are not finite, the first at %u",
                           run->frames, resource->values, resource->name, resource->first);
    }
}

// How many values were clamped in voxels, as the statistics count them.
static void note_cuts(struct stability_view *view)
{
    struct stability_run *run = view->run;
    struct frame_statistics statistics;
    renderer_view_get_statistics(run->suite->renderer, view->view, &statistics);
    for (uint32_t i = 0; i < statistics.reject_count; i++)
        if (strcmp(statistics.rejects[i].name, "voxel_values_cut") == 0 &&
            statistics.rejects[i].count > run->cut_values)
            run->cut_values = statistics.rejects[i].count;
}

// Pixels of FRAME_OUTPUT_LINEAR, which must be finite and not negative, or bytes over 255.
static bool take_picture(struct stability_view *view, const struct frame_pixels *pixels)
{
    picture_finish(&view->picture);
    if (!picture_init(&view->picture, pixels->width, pixels->height))
        return false;
    uint32_t bad = 0;
    for (uint32_t y = 0; y < pixels->height; y++) {
        const uint8_t *bytes = pixels->planes[0] + (size_t)y * pixels->row_pitch_bytes[0];
        const float *floats = (const float *)(const void *)bytes;
        float *target = view->picture.rgb + (size_t)3 * y * pixels->width;
        for (uint32_t i = 0; i < 3 * pixels->width; i++) {
            uint32_t source = 4 * (i / 3) + i % 3;
            bool linear = pixels->output == FRAME_OUTPUT_LINEAR;
            target[i] = linear ? floats[source] : (float)bytes[source] / 255.0f;
            bad += !isfinite(target[i]) || target[i] < 0.0f;
        }
    }
    view->run->bad_values += bad;
    if (bad > 0)
        stability_fail(view->run, "frame %u: %u values of the image are not finite or negative",
                       view->run->frames, bad);
    return true;
}

enum render_result stability_view_draw(struct stability_view *view,
                                       const struct frame_params *params)
{
    struct stability_run *run = view->run;
    struct renderer *renderer = run->suite->renderer;
    struct error error = {""};
    struct frame_pixels pixels;
    enum render_result result = renderer_view_draw(renderer, view->view, params, &error);
    if (result == RENDER_UNCHANGED)
        return result;
    if (result != RENDER_DRAWN || !renderer_view_collect(renderer, view->view, true, &pixels)) {
        stability_fail(run, "frame %u cannot be drawn: %s", run->frames, error.message);
        return RENDER_FAILED;
    }
    run->frames++;
    bool taken = take_picture(view, &pixels);
    renderer_view_release(renderer, view->view);
    check_finite(view);
    note_cuts(view);
    if (!taken)
        stability_fail(run, "out of memory");
    return taken ? RENDER_DRAWN : RENDER_FAILED;
}

bool stability_view_settle(struct stability_view *view, const struct frame_params *params)
{
    for (uint32_t frame = 0; frame < MAX_FRAMES; frame++) {
        enum render_result result = stability_view_draw(view, params);
        if (result == RENDER_FAILED)
            return false;
        if (result == RENDER_UNCHANGED && view->picture.rgb)
            return true;
    }
    stability_fail(view->run, "not settled after %u frames", MAX_FRAMES);
    return false;
}

static bool take_reference(struct stability_run *run, struct reference *reference,
                           struct picture *out_picture)
{
    size_t count = picture_pixel_count(out_picture);
    float *rgba = malloc(count * 4 * sizeof(float));
    if (!rgba)
        return false;
    reference_get_picture(reference, REFERENCE_ALL_LAYERS, rgba);
    for (size_t i = 0; i < 3 * count; i++) {
        float value = rgba[4 * (i / 3) + i % 3];
        out_picture->rgb[i] = value;
        run->bad_values += !isfinite(value) || value < 0.0f;
    }
    free(rgba);
    if (run->bad_values > 0)
        stability_fail(run, "%llu values of the reference are not finite or negative",
                       (unsigned long long)run->bad_values);
    return true;
}

// Traced without a view: a view would show as many samples as time allowed.
static bool trace_reference(struct stability_run *run, struct scene *scene,
                            const struct frame_params *params, struct picture *out_picture)
{
    struct error error = {""};
    struct snapshot *snapshot = snapshot_create(scene, false, &error);
    struct reference *reference =
        snapshot
            ? reference_create(&(struct reference_params){.scene = snapshot,
                                                          .camera = params->camera,
                                                          .width = params->width,
                                                          .height = params->height,
                                                          .max_bounces = params->settings.bounces,
                                                          .threads = 2},
                               &error)
            : NULL;
    if (snapshot)
        snapshot_release(&snapshot);
    bool done = reference && picture_init(out_picture, params->width, params->height) &&
                reference_render(reference, REFERENCE_SAMPLES) &&
                take_reference(run, reference, out_picture);
    if (reference)
        reference_destroy(&reference);
    if (!done)
        stability_fail(run, "the reference cannot be traced: %s", error.message);
    run->frames += done;
    return done;
}

bool stability_draw(struct stability_run *run, struct scene *scene,
                    const struct frame_params *params, struct picture *out_picture)
{
    struct stability_view view;
    *out_picture = (struct picture){0};
    if (params->settings.gi_method == GI_METHOD_REFERENCE)
        return trace_reference(run, scene, params, out_picture);
    bool done = stability_view_open(&view, run, scene) && stability_view_settle(&view, params);
    if (done) {
        *out_picture = view.picture;
        view.picture = (struct picture){0};
    }
    stability_view_close(&view);
    return done;
}

void stability_keep(struct stability_run *run, const struct picture *picture, const char *name)
{
    if (!run->suite->folder || run->picture_count == STABILITY_MAX_PICTURES || !picture->rgb)
        return;
    char *file = run->pictures[run->picture_count];
    char path[4096];
    snprintf(file, sizeof(run->pictures[0]), "%s-%s-%s.png", run->test->name,
             gi_method_names[run->method], name);
    bool kept = false; // already under this name: the newer one replaces it
    for (uint32_t i = 0; i < run->picture_count; i++)
        kept |= strcmp(run->pictures[i], file) == 0;
    snprintf(path, sizeof(path), "%s/%s", run->suite->folder, file);
    uint8_t *bytes = malloc(3 * picture_pixel_count(picture));
    struct display_params display = {.exposure = display_automatic_exposure(picture),
                                     .tonemap = TONEMAP_HABLE};
    struct error error = {""};
    if (!bytes)
        return;
    display_bytes(&display, picture, bytes);
    if (picture_file_write_png(path, picture->width, picture->height, bytes, &error))
        run->picture_count += !kept;
    else
        stability_fail(run, "%s", error.message);
    free(bytes);
}
