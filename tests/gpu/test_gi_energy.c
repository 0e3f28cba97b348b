// Proves that indirect light is as much as it should be: means over images, by colour, against
// the reference path tracer, in the Cornell box and in scenes that nobody tunes to.
//
// Where only lights and planar emitters light, indirect light is compared alone: the image with
// global illumination minus the one without. Skies and glowing bodies are compared as a whole,
// since without global illumination their light is not blocked, or not there.
//
// Coarse voxels are the hard case and the quick one; the box and the ball have those of the preset.
//
// One bounce alone is compared with VOXCAST_TEST_FULL=1; the stability suite compares what each
// bounce adds every time.
//
// A line with the relative error of small blocks follows each comparison; it is for reading, not
// for passing.
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

#define PICTURE_EDGE 64u
// Final quality averages four pixels; the path tracer uses exactly the same camera rays.
#define TRACED_EDGE       (2u * PICTURE_EDGE)
#define SAMPLES           64u
#define BLOCK_EDGE        8u
#define CORNELL_TOLERANCE 0.10
#define OTHER_TOLERANCE   0.15

enum compared { COMPARE_INDIRECT, COMPARE_TOTAL };

static struct scene *cornell_scene(void)
{
    struct error error = {""};
    struct scene *scene = scene_create_builtin("cornell", &error);
    assert_non_null(scene);
    return scene;
}

static const struct energy_case {
    const char *name;
    struct scene *(*create)(void);
    enum compared compared;
    uint32_t bounces; // 0: unlimited
    double tolerance;
    enum voxel_resolution resolution; // automatic in a full run, at 3 times the time
} cases[] = {
    {"cornell", cornell_scene, COMPARE_INDIRECT, 0, CORNELL_TOLERANCE, VOXEL_RESOLUTION_AUTO},
    {"cornell", cornell_scene, COMPARE_INDIRECT, 1, CORNELL_TOLERANCE, VOXEL_RESOLUTION_AUTO},
    {"corridor", gi_corridor_scene, COMPARE_INDIRECT, 0, OTHER_TOLERANCE, VOXEL_RESOLUTION_64},
    {"corridor", gi_corridor_scene, COMPARE_INDIRECT, 1, OTHER_TOLERANCE, VOXEL_RESOLUTION_64},
    {"courtyard", gi_courtyard_scene, COMPARE_TOTAL, 0, OTHER_TOLERANCE, VOXEL_RESOLUTION_64},
    {"metal floor", gi_metal_floor_scene, COMPARE_INDIRECT, 0, OTHER_TOLERANCE,
     VOXEL_RESOLUTION_64},
    {"glowing ball", gi_glowing_ball_scene, COMPARE_TOTAL, 0, OTHER_TOLERANCE,
     VOXEL_RESOLUTION_AUTO},
};

// The reference, averaged down to the image's size.
static void trace(const struct scene *scene, const struct energy_case *c,
                  const struct view_camera *camera, struct test_picture *out_picture)
{
    struct path_params params = {
        .scene = scene,
        .camera = *camera,
        .width = TRACED_EDGE,
        .height = TRACED_EDGE,
        .samples = SAMPLES,
        .bounces = c->bounces == 0 ? PATH_BOUNCES_UNLIMITED : c->bounces,
        .seed = 11,
        .pixel_center = true,
    };
    struct path_picture traced;
    assert_true(path_trace(&params, &traced));
    size_t values = (size_t)PICTURE_EDGE * PICTURE_EDGE * 4;
    *out_picture = (struct test_picture){PICTURE_EDGE, PICTURE_EDGE, calloc(values, sizeof(float))};
    assert_non_null(out_picture->pixels);
    for (size_t y = 0; y < TRACED_EDGE; y++)
        for (size_t x = 0; x < TRACED_EDGE; x++)
            for (size_t channel = 0; channel < 3; channel++) {
                size_t from = (y * TRACED_EDGE + x) * 4 + channel;
                size_t to = (y / 2 * PICTURE_EDGE + x / 2) * 4 + channel;
                float value = traced.indirect[from];
                if (c->compared == COMPARE_TOTAL)
                    value += traced.direct[from] + traced.sky[from];
                out_picture->pixels[to] += 0.25f * value;
            }
    path_picture_finish(&traced);
}

// Root mean square of the differences over the mean, by blocks, over which the reference's noise
// averages out.
static double relative_error(const struct test_picture *a, const struct test_picture *b)
{
    const uint32_t blocks = PICTURE_EDGE / BLOCK_EDGE;
    double squared = 0.0, sum = 0.0;
    for (uint32_t block = 0; block < blocks * blocks * 3; block++) {
        uint32_t channel = block % 3, left = block / 3 % blocks * BLOCK_EDGE;
        uint32_t top = block / 3 / blocks * BLOCK_EDGE;
        double difference = 0.0;
        for (uint32_t i = 0; i < BLOCK_EDGE * BLOCK_EDGE; i++) {
            size_t x = left + i % BLOCK_EDGE, y = top + i / BLOCK_EDGE;
            size_t at = (y * PICTURE_EDGE + x) * 4 + channel;
            difference += (double)a->pixels[at] - b->pixels[at];
            sum += b->pixels[at];
        }
        squared += difference * difference;
    }
    return sqrt(squared * blocks * blocks * 3.0) / sum;
}

static void check_method(struct gi_report *report, struct scene *scene, const struct energy_case *c,
                         enum gi_method method, const struct test_picture *none,
                         const struct test_picture *traced)
{
    static const char *const channels[3] = {"red", "green", "blue"};
    struct frame_params params = gi_params(PICTURE_EDGE, PICTURE_EDGE, method);
    params.quality = QUALITY_FINAL;
    params.settings.bounces = c->bounces;
    params.settings.voxel_resolution = gi_test_is_full() ? VOXEL_RESOLUTION_AUTO : c->resolution;
    gi_scene_camera(scene, &params.camera);
    struct test_picture shown = gi_draw(scene, &params);
    size_t values = (size_t)PICTURE_EDGE * PICTURE_EDGE * 4;
    for (size_t i = 0; i < values && c->compared == COMPARE_INDIRECT; i++)
        shown.pixels[i] -= none->pixels[i];
    double measured[3], expected[3];
    gi_mean(shown.pixels, PICTURE_EDGE, PICTURE_EDGE, measured);
    gi_mean(traced->pixels, PICTURE_EDGE, PICTURE_EDGE, expected);
    for (int channel = 0; channel < 3; channel++)
        gi_check_ratio(report, measured[channel], expected[channel], c->tolerance,
                       "%s %s, %s light, bounces %u, %s", gi_method_names[method], c->name,
                       c->compared == COMPARE_TOTAL ? "all" : "indirect", c->bounces,
                       channels[channel]);
    print_message("      root mean square error of 8 x 8 pixels over the mean: %.3f\n",
                  relative_error(&shown, traced));
    gi_picture_finish(&shown);
}

static void check_cases(const char *name)
{
    struct gi_report report = {0};
    for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
        if (strcmp(cases[i].name, name) != 0 || (cases[i].bounces == 1 && !gi_test_is_full()))
            continue;
        struct scene *scene = cases[i].create();
        struct frame_params params = gi_params(PICTURE_EDGE, PICTURE_EDGE, GI_METHOD_NONE);
        params.quality = QUALITY_FINAL;
        gi_scene_camera(scene, &params.camera);
        struct test_picture none = gi_draw(scene, &params), traced;
        trace(scene, &cases[i], &params.camera, &traced);
        for (uint32_t m = 0; m < GI_PROVED_METHODS; m++)
            check_method(&report, scene, &cases[i], gi_proved_methods[m], &none, &traced);
        gi_picture_finish(&none);
        gi_picture_finish(&traced);
        scene_destroy(&scene);
    }
    gi_report_finish(&report);
}

static void test_cornell_box(void **state)
{
    (void)state;
    check_cases("cornell");
}

static void test_light_around_a_corner(void **state)
{
    (void)state;
    check_cases("corridor");
}

static void test_courtyard_under_a_sky(void **state)
{
    (void)state;
    check_cases("courtyard");
}

static void test_metal_shows_lit_walls(void **state)
{
    (void)state;
    check_cases("metal floor");
}

static void test_glowing_body(void **state)
{
    (void)state;
    check_cases("glowing ball");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_cornell_box),           cmocka_unit_test(test_light_around_a_corner),
        cmocka_unit_test(test_courtyard_under_a_sky), cmocka_unit_test(test_metal_shows_lit_walls),
        cmocka_unit_test(test_glowing_body),
    };
    return cmocka_run_group_tests(tests, NULL, test_renderer_teardown);
}
