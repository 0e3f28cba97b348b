// Proves that a final gather by rays shows what lies between voxels: light under a low table, and a
// room in a mirror, compared with the reference path tracer, where a final gather by voxels does
// not; and the shadows of lights that have a size.
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "renderer/import/scene_load.h"
#include "support_gi.h"
#include "support_gi_scenes.h"

#define PICTURE_EDGE 96u
#define SAMPLES      512u
#define BLOCK_EDGE   4u

// Root mean square of the differences over the mean of indirect light, by blocks.
#define MAX_RAYS 0.10
// Images by voxels err at least so many times as much.
#define MIN_VOXELS 1.4

static void draw_indirect(struct scene *scene, enum gather_mode gather,
                          const struct test_picture *none, struct test_picture *out_picture)
{
    struct frame_params params = gi_params(PICTURE_EDGE, PICTURE_EDGE, GI_METHOD_CLIPMAP);
    params.quality = QUALITY_FINAL;
    params.settings.gather_mode = gather;
    gi_scene_camera(scene, &params.camera);
    *out_picture = gi_draw(scene, &params);
    for (size_t i = 0; i < (size_t)PICTURE_EDGE * PICTURE_EDGE * 4; i++)
        out_picture->pixels[i] -= none->pixels[i];
}

static double block_sum(const float *pixels, uint32_t block, uint32_t channel)
{
    const uint32_t blocks = PICTURE_EDGE / BLOCK_EDGE;
    uint32_t left = block % blocks * BLOCK_EDGE, top = block / blocks * BLOCK_EDGE;
    double sum = 0.0;
    for (uint32_t i = 0; i < BLOCK_EDGE * BLOCK_EDGE; i++) {
        size_t x = left + i % BLOCK_EDGE, y = top + i / BLOCK_EDGE;
        sum += (double)pixels[(y * PICTURE_EDGE + x) * 4 + channel];
    }
    return sum;
}

static double relative_error(const float *a, const float *b)
{
    const uint32_t blocks = PICTURE_EDGE / BLOCK_EDGE;
    double squared = 0.0, sum = 0.0;
    for (uint32_t i = 0; i < blocks * blocks * 3; i++) {
        double expected = block_sum(b, i / 3, i % 3);
        squared += pow(block_sum(a, i / 3, i % 3) - expected, 2.0);
        sum += expected;
    }
    return sqrt(squared * blocks * blocks * 3.0) / sum;
}

static void test_rays_find_what_voxels_do_not(void **state)
{
    (void)state;
    struct scene *scene = gi_table_scene();
    struct frame_params params = gi_params(PICTURE_EDGE, PICTURE_EDGE, GI_METHOD_NONE);
    params.quality = QUALITY_FINAL;
    gi_scene_camera(scene, &params.camera);
    struct path_params path = {.scene = scene,
                               .camera = params.camera,
                               .width = PICTURE_EDGE,
                               .height = PICTURE_EDGE,
                               .samples = SAMPLES,
                               .bounces = PATH_BOUNCES_UNLIMITED,
                               .seed = 5};
    struct path_picture traced;
    assert_true(path_trace(&path, &traced));
    struct test_picture none = gi_draw(scene, &params), cache, rays;
    draw_indirect(scene, GATHER_CACHE, &none, &cache);
    draw_indirect(scene, GATHER_RAYS, &none, &rays);
    double by_cache = relative_error(cache.pixels, traced.indirect);
    double by_rays = relative_error(rays.pixels, traced.indirect);
    struct gi_report report = {0};
    gi_check(&report, by_rays <= MAX_RAYS, "rays err by %.3f of the mean (at most %.2f)", by_rays,
             MAX_RAYS);
    gi_check(&report, by_cache >= MIN_VOXELS * by_rays, "voxels err by %.3f, %g times as much",
             by_cache, by_cache / by_rays);
    gi_picture_finish(&none);
    gi_picture_finish(&cache);
    gi_picture_finish(&rays);
    path_picture_finish(&traced);
    scene_destroy(&scene);
    gi_report_finish(&report);
}

// One ray a pixel is noisier than the cache: while somebody moves, nobody must see that noise or
// wait for less of it.
static void test_pictures_in_motion_show_the_cache(void **state)
{
    (void)state;
    struct error error = {""};
    struct scene *scene = gi_table_scene();
    assert_true(renderer_set_scene(test_renderer(), scene, &error));
    struct frame_params params[2];
    struct view *views[2];
    struct test_picture settled[2] = {0};
    for (int i = 0; i < 2; i++) {
        params[i] = gi_params(PICTURE_EDGE, PICTURE_EDGE, GI_METHOD_GRID);
        params[i].settings.gather_mode = i == 0 ? GATHER_CACHE : GATHER_RAYS;
        gi_scene_camera(scene, &params[i].camera);
        views[i] = renderer_view_create(test_renderer());
        assert_non_null(views[i]);
        assert_true(gi_converge(test_renderer(), views[i], &params[i], &settled[i]) > 0);
    }
    size_t bytes = (size_t)PICTURE_EDGE * PICTURE_EDGE * 4 * sizeof(float);
    assert_int_not_equal(memcmp(settled[0].pixels, settled[1].pixels, bytes), 0);
    for (int step = 0; step < 3; step++) {
        struct test_picture moving[2] = {0};
        for (int i = 0; i < 2; i++) {
            params[i].camera.eye[0] += 0.01f;
            assert_int_equal(gi_draw_once(test_renderer(), views[i], &params[i], &moving[i]),
                             RENDER_DRAWN);
        }
        assert_memory_equal(moving[0].pixels, moving[1].pixels, bytes);
        gi_picture_finish(&moving[0]);
        gi_picture_finish(&moving[1]);
    }
    for (int i = 0; i < 2; i++) {
        gi_picture_finish(&settled[i]);
        renderer_view_destroy(test_renderer(), &views[i]);
    }
    assert_true(renderer_set_scene(test_renderer(), NULL, &error));
    scene_destroy(&scene);
}

#define LIGHT_RADIUS_M 0.2

// Fraction of a disk that a straight edge leaves, which lies so many radii from its centre.
static double disk_fraction(double edge)
{
    double t = fmax(fmin(edge, 1.0), -1.0);
    return 0.5 + (t * sqrt(1.0 - t * t) + asin(t)) / 3.14159265358979;
}

// At position x of the floor, the edge of the sheet hides the part of the light that lies below -x.
static void test_sphere_lights_have_their_penumbra(void **state)
{
    (void)state;
    struct gi_report report = {0};
    static const enum quality qualities[] = {QUALITY_INTERACTIVE, QUALITY_HIGH, QUALITY_FINAL};
    for (int q = 0; q < 3; q++) {
        struct test_picture pictures[2];
        for (int sheet = 0; sheet < 2; sheet++) {
            struct scene *scene = gi_penumbra_scene(sheet, sheet ? (float)LIGHT_RADIUS_M : 0.0f);
            struct frame_params params = gi_params(PICTURE_EDGE, PICTURE_EDGE, GI_METHOD_CLIPMAP);
            params.quality = qualities[q];
            params.settings.soft_shadows = true;
            params.settings.gather_mode = GATHER_RAYS;
            params.debug_view = DEBUG_VIEW_DIRECT;
            gi_scene_camera(scene, &params.camera);
            pictures[sheet] = gi_draw(scene, &params);
            scene_destroy(&scene);
        }
        double worst = 0.0, half_extent_m = 0.8 * tan(0.5);
        for (uint32_t x = 0; x < PICTURE_EDGE; x++) {
            double sums[2] = {0.0, 0.0};
            for (uint32_t y = PICTURE_EDGE * 3 / 8; y < PICTURE_EDGE * 5 / 8; y++)
                for (int i = 0; i < 2; i++)
                    sums[i] += (double)pictures[i].pixels[(y * PICTURE_EDGE + x) * 4];
            double position_m = ((x + 0.5) / PICTURE_EDGE * 2.0 - 1.0) * half_extent_m;
            double expected = disk_fraction(position_m / LIGHT_RADIUS_M);
            worst = fmax(worst, fabs(sums[1] / sums[0] - expected));
        }
        gi_check(&report, worst <= 0.05, "%s: a penumbra is off by %.3f of the light",
                 quality_names[qualities[q]], worst);
        gi_picture_finish(&pictures[0]);
        gi_picture_finish(&pictures[1]);
    }
    gi_report_finish(&report);
}

// Away from pixels that show the light itself.
static double shadow_error(const float *a, const float *reference)
{
    const uint32_t blocks = PICTURE_EDGE / BLOCK_EDGE;
    const double brightest = 2.0 * BLOCK_EDGE * BLOCK_EDGE; // walls have less, cd/m^2
    double squared = 0.0, sum = 0.0;
    uint32_t count = 0;
    for (uint32_t i = 0; i < blocks * blocks; i++) {
        double expected = block_sum(reference, i, 1);
        if (expected > brightest)
            continue;
        squared += pow(block_sum(a, i, 1) - expected, 2.0);
        sum += expected;
        count++;
    }
    return sqrt(squared * count) / sum;
}

static void test_planar_lights_have_their_penumbra(void **state)
{
    (void)state;
    struct error error = {""};
    struct scene *scene = scene_load("builtin:cornell", &error);
    assert_non_null(scene);
    struct frame_params params = gi_params(PICTURE_EDGE, PICTURE_EDGE, GI_METHOD_CLIPMAP);
    params.quality = QUALITY_HIGH;
    params.debug_view = DEBUG_VIEW_DIRECT;
    params.settings.gather_mode = GATHER_RAYS;
    gi_scene_camera(scene, &params.camera);
    struct path_params path = {.scene = scene,
                               .camera = params.camera,
                               .width = PICTURE_EDGE,
                               .height = PICTURE_EDGE,
                               .samples = SAMPLES,
                               .bounces = 0,
                               .seed = 5,
                               .pixel_center = true};
    struct path_picture traced;
    assert_true(path_trace(&path, &traced));
    struct test_picture hard = gi_draw(scene, &params);
    params.settings.soft_shadows = true;
    struct test_picture soft = gi_draw(scene, &params);
    double by_maps = shadow_error(hard.pixels, traced.direct);
    double by_rays = shadow_error(soft.pixels, traced.direct);
    struct gi_report report = {0};
    gi_check(&report, by_rays <= 0.02, "rays err by %.3f of the mean", by_rays);
    gi_check(&report, by_maps >= 3.0 * by_rays, "shadows of the lamp's middle by %.3f", by_maps);
    gi_picture_finish(&hard);
    gi_picture_finish(&soft);
    path_picture_finish(&traced);
    scene_destroy(&scene);
    gi_report_finish(&report);
}

// What rays have found is valid only for what they were traced for: another debug view or another
// effect in the same view starts them anew.
static void test_rays_start_anew_where_more_is_asked(void **state)
{
    (void)state;
    struct gi_report report = {0};
    struct scene *scene = gi_penumbra_scene(true, (float)LIGHT_RADIUS_M);
    struct frame_params wanted = gi_params(PICTURE_EDGE, PICTURE_EDGE, GI_METHOD_CLIPMAP);
    wanted.settings.soft_shadows = true;
    wanted.settings.gather_mode = GATHER_RAYS;
    gi_scene_camera(scene, &wanted.camera);
    struct test_picture fresh = gi_draw(scene, &wanted);
    for (int i = 0; i < 2; i++) {
        struct frame_params before = wanted;
        if (i == 0)
            before.debug_view = DEBUG_VIEW_ALBEDO;
        else
            before.settings.soft_shadows = false;
        struct view *view = gi_show(scene);
        struct test_picture other = gi_draw_in(view, &before);
        struct test_picture later = gi_draw_in(view, &wanted);
        gi_hide(&view);
        double error = relative_error(later.pixels, fresh.pixels);
        gi_check(&report, error <= 0.005, "after %s the picture differs by %.4f of the mean",
                 i == 0 ? "another debug view" : "hard shadows", error);
        gi_picture_finish(&other);
        gi_picture_finish(&later);
    }
    gi_picture_finish(&fresh);
    scene_destroy(&scene);
    gi_report_finish(&report);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_rays_find_what_voxels_do_not),
        cmocka_unit_test(test_pictures_in_motion_show_the_cache),
        cmocka_unit_test(test_sphere_lights_have_their_penumbra),
        cmocka_unit_test(test_planar_lights_have_their_penumbra),
        cmocka_unit_test(test_rays_start_anew_where_more_is_asked),
    };
    return cmocka_run_group_tests(tests, NULL, test_renderer_teardown);
}
