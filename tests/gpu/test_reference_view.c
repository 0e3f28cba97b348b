// Proves that a view with the method `reference` shows what the path tracer computes, through the
// same outputs as every other image, shows direct light until then, and leaves nothing behind when
// the method changes.
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "renderer/import/scene_load.h"
#include "support_gi.h"
#include "support_gi_scenes.h"

#define EDGE    48u
#define WAIT_MS 60000
#define POLL_US 5000
#define SAMPLES 8u
#define PIXELS  ((size_t)EDGE * EDGE)

struct fixture {
    struct renderer *renderer;
    struct view *view;
    struct scene *scene;
    struct frame_params params;
    float pixels[PIXELS * 4];
    uint32_t samples; // of the newest image
};

static struct fixture fixture;

// Draws once; false if there is nothing new.
static bool draw(void)
{
    struct error error = {""};
    enum render_result result =
        renderer_view_draw(fixture.renderer, fixture.view, &fixture.params, &error);
    if (result == RENDER_PENDING || result == RENDER_UNCHANGED)
        return false;
    assert_int_equal(result, RENDER_DRAWN);
    struct frame_pixels pixels;
    assert_true(renderer_view_collect(fixture.renderer, fixture.view, true, &pixels));
    assert_int_equal(pixels.row_pitch_bytes[0], EDGE * 16);
    memcpy(fixture.pixels, pixels.planes[0], sizeof(fixture.pixels));
    fixture.samples = pixels.reference_samples;
    renderer_view_release(fixture.renderer, fixture.view);
    return true;
}

static void draw_until_traced(void)
{
    for (int waited_us = 0; waited_us < WAIT_MS * 1000; waited_us += POLL_US) {
        if (draw() && fixture.samples >= SAMPLES)
            return;
        usleep(POLL_US);
    }
    fail_msg("no reference of %u samples in %d ms", SAMPLES, WAIT_MS);
}

static int set_up(void **state)
{
    (void)state;
    struct error error = {""};
    fixture.scene = scene_load("builtin:cornell", &error);
    assert_non_null(fixture.scene);
    fixture.renderer = test_renderer();
    assert_true(renderer_set_scene(fixture.renderer, fixture.scene, &error));
    fixture.view = renderer_view_create(fixture.renderer);
    assert_non_null(fixture.view);
    fixture.params = gi_params(EDGE, EDGE, GI_METHOD_NONE);
    fixture.params.quality = QUALITY_HIGH;
    gi_scene_camera(fixture.scene, &fixture.params.camera);
    return 0;
}

static int tear_down(void **state)
{
    (void)state;
    struct error error;
    renderer_view_destroy(fixture.renderer, &fixture.view);
    renderer_set_scene(fixture.renderer, NULL, &error);
    scene_destroy(&fixture.scene);
    return 0;
}

static double mean_of_traced(void)
{
    struct path_params params = {.scene = fixture.scene,
                                 .camera = fixture.params.camera,
                                 .width = EDGE,
                                 .height = EDGE,
                                 .samples = 256,
                                 .bounces = PATH_BOUNCES_UNLIMITED,
                                 .seed = 1};
    struct path_picture traced;
    assert_true(path_trace(&params, &traced));
    double direct[3], indirect[3];
    gi_mean(traced.direct, EDGE, EDGE, direct);
    gi_mean(traced.indirect, EDGE, EDGE, indirect);
    path_picture_finish(&traced);
    return direct[0] + indirect[0];
}

static void test_view_shows_the_reference(void **state)
{
    (void)state;
    struct gi_report report = {0};
    double mean[3];
    fixture.params.settings.gi_method = GI_METHOD_REFERENCE;
    assert_true(draw());
    assert_int_equal(fixture.samples, 0); // direct light first
    draw_until_traced();
    gi_mean(fixture.pixels, EDGE, EDGE, mean);
    gi_check_ratio(&report, mean[0], mean_of_traced(), 0.05, "view by reference, %u samples",
                   fixture.samples);
    // An edit starts it anew; a row that draws at half the size does not affect it.
    fixture.params.quality = QUALITY_DRAFT;
    struct scene_material black = fixture.scene->materials[0];
    for (uint32_t i = 0; i < fixture.scene->material_count; i++) {
        black = fixture.scene->materials[i];
        memset(black.base_color, 0, 3 * sizeof(float));
        scene_set_material(fixture.scene, i, &black);
    }
    assert_true(draw());
    assert_int_equal(fixture.samples, 0);
    draw_until_traced();
    gi_mean(fixture.pixels, EDGE, EDGE, mean);
    gi_check_ratio(&report, mean[0], mean_of_traced(), 0.05, "the same with black walls");
    gi_report_finish(&report);
}

static void test_methods_leave_nothing_behind(void **state)
{
    (void)state;
    float before[PIXELS * 4];
    for (int moved = 0; moved < 2; moved++) {
        fixture.params.settings.gi_method = GI_METHOD_NONE;
        fixture.params.camera.eye[0] += 0.01f;
        assert_true(draw());
        memcpy(before, fixture.pixels, sizeof(before));
        fixture.params.settings.gi_method = GI_METHOD_REFERENCE;
        fixture.params.camera.eye[0] += moved ? 0.02f : 0.0f;
        draw_until_traced();
        fixture.params.settings.gi_method = GI_METHOD_NONE;
        fixture.params.camera.eye[0] -= moved ? 0.02f : 0.0f;
        assert_true(draw());
        assert_int_equal(fixture.samples, 0);
        assert_memory_equal(before, fixture.pixels, sizeof(before));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_view_shows_the_reference, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_methods_leave_nothing_behind, set_up, tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, test_renderer_teardown);
}
