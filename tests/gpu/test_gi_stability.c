// Proves that global illumination in motion stays correct: while the camera or an object moves
// every value is finite, and the image that converges afterwards is the one to which a new renderer
// converges.
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

#include "renderer/import/scene_load.h"
#include "support_gi.h"
#include "support_gi_scenes.h"

#define PICTURE_EDGE 48u
#define STEPS        40u
#define TOLERANCE    2.0 // of 255

static uint32_t find_node(const struct scene *scene, const char *name)
{
    for (uint32_t i = 0; i < scene->node_count; i++)
        if (strcmp(scene->nodes[i].name, name) == 0)
            return i;
    fail_msg("there is no node \"%s\"", name);
    return SCENE_NONE;
}

static uint32_t count_bad_values(const struct frame_pixels *pixels)
{
    uint32_t bad = 0;
    for (uint32_t y = 0; y < pixels->height; y++) {
        const float *row =
            (const float *)(const void *)(pixels->planes[0] + y * pixels->row_pitch_bytes[0]);
        for (uint32_t i = 0; i < 4 * pixels->width; i++)
            bad += !isfinite(row[i]) || row[i] < 0.0f;
    }
    return bad;
}

static void draw_step(struct renderer *renderer, struct view *view,
                      const struct frame_params *params, uint32_t *bad_values)
{
    struct error error = {""};
    struct frame_pixels pixels;
    if (renderer_view_draw(renderer, view, params, &error) != RENDER_DRAWN)
        fail_msg("%s", error.message);
    assert_true(renderer_view_collect(renderer, view, true, &pixels));
    *bad_values += count_bad_values(&pixels);
    renderer_view_release(renderer, view);
}

static void set_camera(struct view_camera *camera, const struct view_camera *start, uint32_t step)
{
    float angle = 0.8f * (float)step / STEPS;
    camera->eye[0] = start->eye[0] + 0.25f * sinf(3.0f * angle);
    camera->eye[1] = start->eye[1] + 0.1f * sinf(7.0f * angle);
    camera->eye[2] = start->eye[2] - 0.9f * angle;
}

static void add_block(struct scene *scene, uint32_t node, uint32_t step)
{
    float angle = 0.9f * (float)step / STEPS;
    scene_set_node_transform(scene, node, (float[3]){-0.1f * angle, 0.12f * angle, 0.15f * angle},
                             (float[4]){0.0f, sinf(0.5f * angle), 0.0f, cosf(0.5f * angle)},
                             (float[3]){1.0f, 1.0f, 1.0f});
}

static double largest_difference(const struct test_picture *a, const struct test_picture *b)
{
    double largest = 0.0;
    for (size_t i = 0; i < (size_t)PICTURE_EDGE * PICTURE_EDGE * 4; i++)
        largest = fmax(largest, fabs((double)a->pixels[i] - b->pixels[i]));
    return largest;
}

// Compares what the view converges to with what a new view shows after the scene was hidden and
// shown again; and that with an image without global illumination.
static void check_rest(struct gi_report *report, struct renderer *renderer, struct view *view,
                       struct scene *scene, struct frame_params params, const char *what)
{
    struct error error;
    struct test_picture walked = {0};
    params.output = FRAME_OUTPUT_RGBA8;
    assert_true(gi_converge(renderer, view, &params, &walked) > 0);
    renderer_set_scene(renderer, NULL, &error);
    struct test_picture fresh = gi_draw(scene, &params);
    const char *method = gi_method_names[params.settings.gi_method];
    double difference = largest_difference(&walked, &fresh);
    gi_check(report, difference <= TOLERANCE,
             "%s, %s moved: differs from a fresh picture by %g of 255 at most (within %g)", method,
             what, difference, TOLERANCE);
    params.settings.gi_method = GI_METHOD_NONE;
    struct test_picture none = gi_draw(scene, &params);
    difference = largest_difference(&none, &fresh);
    gi_check(report, difference > 10.0 * TOLERANCE,
             "%s, %s moved: differs from a picture without by %g of 255 at most (above %g)", method,
             what, difference, 10.0 * TOLERANCE);
    gi_picture_finish(&walked);
    gi_picture_finish(&fresh);
    gi_picture_finish(&none);
}

static void check_walk(struct gi_report *report, enum gi_method method, bool moves_camera)
{
    struct renderer *renderer = test_renderer();
    struct error error = {""};
    struct scene *scene = scene_create_builtin("cornell", &error);
    assert_non_null(scene);
    assert_true(renderer_set_scene(renderer, scene, &error));
    struct view *view = renderer_view_create(renderer);
    uint32_t block = find_node(scene, "short block"), bad_values = 0;
    struct frame_params params = gi_params(PICTURE_EDGE, PICTURE_EDGE, method);
    struct view_camera start;
    gi_scene_camera(scene, &start);
    params.camera = start;
    for (uint32_t step = 1; step <= STEPS; step++) {
        if (moves_camera)
            set_camera(&params.camera, &start, step);
        else
            add_block(scene, block, step);
        draw_step(renderer, view, &params, &bad_values);
    }
    const char *what = moves_camera ? "camera" : "object";
    gi_check(report, bad_values == 0, "%s, %s moves: %u values not finite or below 0",
             gi_method_names[method], what, bad_values);
    check_rest(report, renderer, view, scene, params, what);
    renderer_view_destroy(renderer, &view);
    scene_destroy(&scene);
}

static void test_camera_moves(void **state)
{
    (void)state;
    struct gi_report report = {0};
    for (uint32_t m = 0; m < GI_PROVED_METHODS; m++)
        check_walk(&report, gi_proved_methods[m], true);
    gi_report_finish(&report);
}

static void test_object_moves(void **state)
{
    (void)state;
    struct gi_report report = {0};
    for (uint32_t m = 0; m < GI_PROVED_METHODS; m++)
        check_walk(&report, gi_proved_methods[m], false);
    gi_report_finish(&report);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_camera_moves),
        cmocka_unit_test(test_object_moves),
    };
    return cmocka_run_group_tests(tests, NULL, test_renderer_teardown);
}
