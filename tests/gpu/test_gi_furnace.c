// Proves that voxel global illumination neither adds nor loses light: in a closed box whose walls
// reflect a fraction a of light and emit L each, everything shows L / (1 - a), after n reflections
// L (1 + a + ... + a^n); and the flux of a light in the box equals what its walls absorb.
//
// Runs a selection of resolutions, steps and gather modes; VOXCAST_TEST_FULL=1 runs all of them.
// The stability suite checks the series of bounces in the cache, too; here it runs in full alone.
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>

#include <cmocka.h>

#include "support_gi.h"
#include "support_gi_scenes.h"

#define PICTURE_EDGE 40u
#define EMISSION     2.0
#define HALF_EDGE_M  1.3
#define ODD_TURN_RAD 0.41f
// More quads than a planar emitter may have triangles.
#define MANY_DIVISIONS 4u

#define MEAN_TOLERANCE 0.03
// A bound for all but one of a hundred pixels.
#define PIXEL_TOLERANCE 0.10
#define LIGHT_TOLERANCE 0.05

struct furnace_case {
    float albedo;
    enum voxel_resolution resolution;
    float cone_step;
    enum gather_mode gather_mode;
    float turn_rad;
    uint32_t divisions;
    uint32_t bounces; // 0: unlimited
};

static const struct furnace_case selection[] = {
    {0.2f, VOXEL_RESOLUTION_64, 1.0f, GATHER_CACHE, 0.0f, 1, 0},
    {0.5f, VOXEL_RESOLUTION_64, 0.25f, GATHER_HALF, ODD_TURN_RAD, 1, 0},
    {0.8f, VOXEL_RESOLUTION_64, 2.0f, GATHER_PIXEL, ODD_TURN_RAD, 1, 0},
    {0.5f, VOXEL_RESOLUTION_128, 1.0f, GATHER_CACHE, 0.0f, 1, 0},
    {0.8f, VOXEL_RESOLUTION_64, 1.0f, GATHER_CACHE, ODD_TURN_RAD, MANY_DIVISIONS, 0},
    {0.5f, VOXEL_RESOLUTION_64, 1.0f, GATHER_PIXEL, 0.0f, MANY_DIVISIONS, 0},
    {0.5f, VOXEL_RESOLUTION_64, 1.0f, GATHER_RAYS, ODD_TURN_RAD, 1, 0},
    {0.8f, VOXEL_RESOLUTION_64, 1.0f, GATHER_RAYS, 0.0f, MANY_DIVISIONS, 0},
};

// The walls are emitters so large that cones gather their light, whether they have few triangles or
// many: their first reflection is the first bounce.
static double furnace_series(const struct furnace_case *c)
{
    double series = 1.0 / (1.0 - c->albedo);
    return c->bounces == 0 ? series : series * (1.0 - pow(c->albedo, c->bounces + 1.0));
}

static void check_furnace(struct gi_report *report, enum gi_method method,
                          const struct furnace_case *c)
{
    struct scene *scene = gi_box_scene(&(struct gi_box_params){.albedo = c->albedo,
                                                               .emission = (float)EMISSION,
                                                               .half_edge_m = (float)HALF_EDGE_M,
                                                               .turn_rad = c->turn_rad,
                                                               .divisions = c->divisions});
    struct frame_params params = gi_params(PICTURE_EDGE, PICTURE_EDGE, method);
    gi_scene_camera(scene, &params.camera);
    params.settings.voxel_resolution = c->resolution;
    params.settings.cone_step = c->cone_step;
    params.settings.gather_mode = c->gather_mode;
    params.settings.bounces = c->bounces;
    struct test_picture picture = gi_draw(scene, &params);
    double expected = EMISSION * furnace_series(c), mean[3];
    gi_mean(picture.pixels, picture.width, picture.height, mean);
    double low = gi_quantile(&picture, 0.01) / expected;
    double high = gi_quantile(&picture, 0.99) / expected;
    char name[160];
    snprintf(name, sizeof(name), "%s %s step %g %s albedo %g turn %g %s bounces %u",
             gi_method_names[method], voxel_resolution_names[c->resolution], (double)c->cone_step,
             gather_mode_names[c->gather_mode], (double)c->albedo, (double)c->turn_rad,
             c->divisions == 1 ? "quads" : "many", c->bounces);
    gi_check_ratio(report, mean[0], expected, MEAN_TOLERANCE, "%s", name);
    gi_check(report, low >= 1.0 - PIXEL_TOLERANCE && high <= 1.0 + PIXEL_TOLERANCE,
             "%s: pixels from %.4f to %.4f of what is expected (within %g)", name, low, high,
             PIXEL_TOLERANCE);
    gi_picture_finish(&picture);
    scene_destroy(&scene);
}

static void check_all_combinations(struct gi_report *report, enum gi_method method)
{
    static const float albedos[] = {0.2f, 0.5f, 0.8f};
    static const float steps[] = {0.25f, 1.0f, 2.0f};
    static const float turns_rad[] = {0.0f, ODD_TURN_RAD};
    static const uint32_t divisions[] = {1, MANY_DIVISIONS};
    // Clip levels are never finer than 128.
    int last = method == GI_METHOD_GRID ? VOXEL_RESOLUTION_256 : VOXEL_RESOLUTION_128;
    for (int resolution = VOXEL_RESOLUTION_64; resolution <= last; resolution++)
        for (int gather = GATHER_CACHE; gather <= GATHER_RAYS; gather++)
            for (int i = 0; i < 3 * 3 * 2 * 2; i++)
                check_furnace(report, method,
                              &(struct furnace_case){
                                  .albedo = albedos[i % 3],
                                  .resolution = (enum voxel_resolution)resolution,
                                  .cone_step = steps[i / 3 % 3],
                                  .gather_mode = (enum gather_mode)gather,
                                  .turn_rad = turns_rad[i / 9 % 2],
                                  .divisions = divisions[i / 18],
                              });
}

static void test_furnace_is_even(void **state)
{
    (void)state;
    struct gi_report report = {0};
    for (uint32_t m = 0; m < GI_PROVED_METHODS; m++) {
        if (gi_test_is_full())
            check_all_combinations(&report, gi_proved_methods[m]);
        for (size_t i = 0; i < sizeof(selection) / sizeof(selection[0]); i++)
            check_furnace(&report, gi_proved_methods[m], &selection[i]);
    }
    gi_report_finish(&report);
}

static void test_bounces_are_a_geometric_series(void **state)
{
    (void)state;
    struct gi_report report = {0};
    for (uint32_t m = 0; m < GI_PROVED_METHODS; m++)
        for (uint32_t bounces = 1; bounces <= 3; bounces++)
            for (uint32_t divisions = gi_test_is_full() ? 1 : MANY_DIVISIONS;
                 divisions <= MANY_DIVISIONS; divisions += MANY_DIVISIONS - 1)
                check_furnace(&report, gi_proved_methods[m],
                              &(struct furnace_case){
                                  .albedo = 0.6f,
                                  .resolution = VOXEL_RESOLUTION_64,
                                  .cone_step = 1.0f,
                                  .gather_mode = divisions == 1 ? GATHER_CACHE : GATHER_RAYS,
                                  .turn_rad = bounces == 2 ? ODD_TURN_RAD : 0.0f,
                                  .divisions = divisions,
                                  .bounces = bounces,
                              });
    gi_report_finish(&report);
}

// Irradiance x area x (1 - albedo) is the flux; the mean over walls seen squarely.
static void test_light_in_a_box_balances(void **state)
{
    (void)state;
    struct gi_report report = {0};
    const double intensity_cd = 15.0;
    static const float albedos[] = {0.3f, 0.7f};
    for (int i = 0; i < 2 * 2 * (int)GI_PROVED_METHODS; i++) {
        enum gi_method method = gi_proved_methods[i / 4];
        double albedo = albedos[i % 2];
        struct gi_box_params box = {.albedo = (float)albedo,
                                    .intensity_cd = (float)intensity_cd,
                                    .half_edge_m = (float)HALF_EDGE_M,
                                    .turn_rad = i / 2 % 2 ? ODD_TURN_RAD : 0.0f,
                                    .divisions = 1};
        struct scene *scene = gi_box_scene(&box);
        struct frame_params params = gi_params(PICTURE_EDGE, PICTURE_EDGE, method);
        uint32_t step = gi_test_is_full() ? 1 : 2, walls = 0;
        double sum = 0.0;
        struct view *view = gi_show(scene);
        for (uint32_t wall = 0; wall < 6; wall += step) {
            gi_box_look_at_wall(box.turn_rad, wall, &params.camera);
            struct test_picture picture = gi_draw_in(view, &params);
            double mean[3];
            gi_mean(picture.pixels, picture.width, picture.height, mean);
            sum += mean[0];
            walls++;
            gi_picture_finish(&picture);
        }
        gi_hide(&view);
        double area = 24.0 * HALF_EDGE_M * HALF_EDGE_M;
        double expected = albedo / M_PI * 4.0 * M_PI * intensity_cd / area / (1.0 - albedo);
        gi_check_ratio(&report, sum / walls, expected, LIGHT_TOLERANCE,
                       "%s lamp in a box, albedo %g, turn %g", gi_method_names[method], albedo,
                       (double)box.turn_rad);
        scene_destroy(&scene);
    }
    gi_report_finish(&report);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_furnace_is_even),
        cmocka_unit_test(test_bounces_are_a_geometric_series),
        cmocka_unit_test(test_light_in_a_box_balances),
    };
    return cmocka_run_group_tests(tests, NULL, test_renderer_teardown);
}
