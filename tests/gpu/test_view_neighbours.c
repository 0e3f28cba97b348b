// Proves that views do not change each other's images: a view with settings of its own has voxels
// of its own, a view that takes shadow cascades leaves those of others unchanged, and when shared
// settings change, more views than there are volumes can be drawn. Images of a view that is drawn
// anew after its neighbour are compared bit by bit.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

#include "renderer/gi/voxel/volume.h"
#include "support_gi.h"
#include "support_gi_scenes.h"

#define WIDTH     64u
#define HEIGHT    36u
#define MANY      (VOXEL_MAX_SHARED_VOLUMES + 2u)
#define EYE_STEPS 6u

static struct scene *show(const char *name)
{
    struct error error = {""};
    struct scene *scene = scene_create_builtin(name, &error);
    if (!scene || !renderer_set_scene(test_renderer(), scene, &error))
        fail_msg("%s", error.message);
    return scene;
}

static void hide(struct scene **scene)
{
    struct error ignored;
    renderer_set_scene(test_renderer(), NULL, &ignored);
    scene_destroy(scene);
}

static bool same_pixels(const struct test_picture *a, const struct test_picture *b)
{
    return a->width == b->width && a->height == b->height &&
           memcmp(a->pixels, b->pixels, (size_t)4 * a->width * a->height * sizeof(float)) == 0;
}

// Draws anew; returns how many frames it took to converge.
static uint32_t draw_anew(struct view *view, const struct frame_params *params,
                          struct test_picture *out_picture)
{
    renderer_view_invalidate(view);
    uint32_t frames = gi_converge(test_renderer(), view, params, out_picture);
    assert_true(frames > 0);
    return frames;
}

// A neighbour with other bounces resets a shared grid, but not one of its own.
static void test_own_voxels(void **state)
{
    (void)state;
    struct gi_report report = {0};
    struct renderer *renderer = test_renderer();
    struct scene *scene = show("cornell");
    struct frame_params params = gi_params(WIDTH, HEIGHT, GI_METHOD_GRID), other;
    gi_scene_camera(scene, &params.camera);
    for (int own = 0; own < 2; own++) {
        struct view *view = renderer_view_create(renderer);
        struct view *neighbour = renderer_view_create(renderer);
        struct test_picture before = {0}, after = {0}, others = {0};
        draw_anew(view, &params, &before);
        other = params;
        other.own_voxels = own;
        other.settings.bounces = 1;
        draw_anew(neighbour, &other, &others);
        gi_check(&report, !same_pixels(&before, &others), "own %d: the neighbour is another", own);
        uint32_t frames = draw_anew(view, &params, &after);
        if (own) {
            gi_check(&report, frames == 1, "own voxels: %u frames after the neighbour's", frames);
            gi_check(&report, same_pixels(&before, &after), "own voxels: the same bits as before");
        } else {
            gi_check(&report, frames > 1, "shared voxels: %u frames after it", frames);
        }
        gi_picture_finish(&before);
        gi_picture_finish(&after);
        gi_picture_finish(&others);
        renderer_view_destroy(renderer, &view);
        renderer_view_destroy(renderer, &neighbour);
    }
    hide(&scene);
    gi_report_finish(&report);
}

// Each view is drawn once with the old settings, then once with the new ones.
static void test_many_views(void **state)
{
    (void)state;
    struct renderer *renderer = test_renderer();
    struct scene *scene = show("cornell");
    struct frame_params params = gi_params(WIDTH, HEIGHT, GI_METHOD_CLIPMAP);
    struct view *views[MANY];
    struct error error = {""};
    struct frame_pixels pixels;
    gi_scene_camera(scene, &params.camera);
    for (uint32_t i = 0; i < MANY; i++)
        views[i] = renderer_view_create(renderer);
    for (uint32_t i = 0; i < 2 * MANY; i++) {
        struct view *view = views[i % MANY];
        params.settings.cone_set = i < MANY ? CONE_SET_5 : CONE_SET_9;
        if (renderer_view_draw(renderer, view, &params, &error) != RENDER_DRAWN)
            fail_msg("view %u of %u: %s", i % MANY, MANY, error.message);
        assert_true(renderer_view_collect(renderer, view, true, &pixels));
        renderer_view_release(renderer, view);
    }
    // Views that must not share a grid are refused in words; others are not.
    params.own_voxels = true;
    for (uint32_t i = 0; i < MANY; i++) {
        bool fits = i < VOXEL_MAX_OWN_VOLUMES;
        enum render_result result = renderer_view_draw(renderer, views[i], &params, &error);
        assert_int_equal(result, fits ? RENDER_DRAWN : RENDER_FAILED);
        if (!fits)
            assert_non_null(strstr(error.message, "settings of their own"));
        else
            assert_true(renderer_view_collect(renderer, views[i], true, &pixels));
        if (fits)
            renderer_view_release(renderer, views[i]);
    }
    for (uint32_t i = 0; i < MANY; i++)
        renderer_view_destroy(renderer, &views[i]);
    hide(&scene);
}

// Draws the view, then a neighbour of higher quality, whose cascades need more layers than there
// are, so that all are drawn anew, and then the view again. The camera has moved meanwhile, so that
// cascades placed now would lie elsewhere than those that it still uses.
static bool check_cascades(float step_m)
{
    struct renderer *renderer = test_renderer();
    struct scene *scene = show("atrium");
    struct frame_params params = gi_params(WIDTH, HEIGHT, GI_METHOD_NONE);
    struct view *view = renderer_view_create(renderer);
    struct view *neighbour = renderer_view_create(renderer);
    struct test_picture before = {0}, after = {0}, others = {0};
    gi_scene_camera(scene, &params.camera);
    params.quality = QUALITY_INTERACTIVE;
    draw_anew(view, &params, &before);
    params.camera.eye[0] += step_m;
    params.camera.target[0] += step_m;
    draw_anew(view, &params, &before);
    struct frame_params other = params;
    other.quality = QUALITY_FINAL;
    draw_anew(neighbour, &other, &others);
    draw_anew(view, &params, &after);
    bool same = same_pixels(&before, &after);
    gi_picture_finish(&before);
    gi_picture_finish(&after);
    gi_picture_finish(&others);
    renderer_view_destroy(renderer, &neighbour);
    renderer_view_destroy(renderer, &view);
    hide(&scene);
    return same;
}

static void test_cascades(void **state)
{
    (void)state;
    struct gi_report report = {0};
    for (uint32_t i = 0; i < EYE_STEPS; i++) {
        float step_m = 0.7f * (float)i;
        gi_check(&report, check_cascades(step_m), "cascades after %.1f m: the same bits", step_m);
    }
    gi_report_finish(&report);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_own_voxels),
        cmocka_unit_test(test_many_views),
        cmocka_unit_test(test_cascades),
    };
    return cmocka_run_group_tests(tests, NULL, test_renderer_teardown);
}
