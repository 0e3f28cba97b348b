// Proves that occlusion culling hides nothing that is seen: a view whose camera moves, jumps and
// comes back shows the same triangles in each frame, bit by bit, as a view that is drawn for the
// first time, which culls nothing.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

#include "renderer/frame/view.h"
#include "support_gi.h"
#include "support_gi_scenes.h"

#define WIDTH  160u
#define HEIGHT 90u

static struct test_picture draw_ids(struct view *view, const struct frame_params *params)
{
    struct error error = {""};
    struct frame_pixels pixels;
    if (renderer_view_draw(test_renderer(), view, params, &error) != RENDER_DRAWN)
        fail_msg("%s", error.message);
    assert_true(renderer_view_collect(test_renderer(), view, true, &pixels));
    size_t bytes = (size_t)4 * WIDTH * HEIGHT * sizeof(float);
    struct test_picture picture = {WIDTH, HEIGHT, malloc(bytes)};
    memcpy(picture.pixels, pixels.planes[0], bytes);
    renderer_view_release(test_renderer(), view);
    return picture;
}

static uint32_t count_differences(const struct test_picture *a, const struct test_picture *b)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < WIDTH * HEIGHT; i++)
        count += memcmp(a->pixels + 4 * i, b->pixels + 4 * i, 4 * sizeof(float)) != 0;
    return count;
}

// Into the building, along a wall, back out, and behind a column.
static const struct {
    float eye[3];
    float target[3];
} poses[] = {
    {{0.0f, 1.7f, 0.0f}, {6.0f, 2.0f, 0.5f}},   {{-7.0f, 1.7f, 3.0f}, {7.0f, 1.5f, 3.2f}},
    {{3.0f, 4.5f, -3.0f}, {-5.0f, 4.0f, 0.0f}}, {{0.0f, 1.7f, 0.0f}, {-6.0f, 2.0f, -0.5f}},
    {{0.0f, 12.0f, 0.1f}, {0.0f, 0.0f, 0.0f}},
};

static void test_moving_camera(void **state)
{
    (void)state;
    struct renderer *renderer = test_renderer();
    struct error error = {""};
    struct scene *scene = scene_create_builtin("atrium", &error);
    if (!scene || !renderer_set_scene(renderer, scene, &error))
        fail_msg("%s", error.message);
    struct frame_params params = test_params(WIDTH, HEIGHT, FRAME_OUTPUT_LINEAR);
    params.debug_view = DEBUG_VIEW_IDS;
    struct view *moving = renderer_view_create(renderer);
    uint32_t twice = 0;
    for (size_t i = 0; i < sizeof(poses) / sizeof(poses[0]); i++)
        for (uint32_t step = 0; step < 4; step++) {
            for (int axis = 0; axis < 3; axis++) {
                params.camera.eye[axis] = poses[i].eye[axis] + 0.05f * (float)step;
                params.camera.target[axis] = poses[i].target[axis];
            }
            moving->occlusion.frames_until = 0; // also where it would not pay
            twice += moving->occlusion.has_seen;
            struct test_picture culled = draw_ids(moving, &params);
            struct view *fresh = renderer_view_create(renderer);
            struct test_picture whole = draw_ids(fresh, &params);
            uint32_t differences = count_differences(&culled, &whole);
            if (differences > 0)
                fail_msg("place %zu, step %u: %u pixels differ", i, step, differences);
            renderer_view_destroy(renderer, &fresh);
            free(culled.pixels);
            free(whole.pixels);
        }
    print_message("%u frames in two passes\n", twice);
    if (renderer_get_info(renderer)->software)
        assert_true(twice >= 5);
    renderer_view_destroy(renderer, &moving);
    renderer_set_scene(renderer, NULL, &error);
    scene_destroy(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_moving_camera)};
    return cmocka_run_group_tests(tests, NULL, test_renderer_teardown);
}
