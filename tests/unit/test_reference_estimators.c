// Proves that sampling lights, sampling BSDFs and their weighted combination agree: independent
// estimators of the same light that share only the physics. Compares means over images by many
// seeds each, whose spread shows what chance allows.
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "renderer/import/scene_load.h"
#include "support_reference.h"

#define SEEDS 6
// Of the difference of two means; chance exceeds it once in 10^5 cases.
#define STANDARD_ERRORS 4.5

struct estimate {
    double mean, standard_error;
};

static struct estimate estimate(const struct scene *scene, struct reference_params params,
                                enum reference_estimator estimator, uint32_t samples)
{
    double sum = 0.0, squares = 0.0;
    params.estimator = estimator;
    for (uint32_t seed = 0; seed < SEEDS; seed++) {
        double mean[3];
        params.seed = 100u * (uint32_t)estimator + seed;
        support_reference_mean(scene, &params, samples, REFERENCE_ALL_LAYERS, mean);
        double value = mean[0] + mean[1] + mean[2];
        sum += value / SEEDS;
        squares += value * value / SEEDS;
    }
    double variance = fmax(squares - sum * sum, 0.0) * SEEDS / (SEEDS - 1.0);
    return (struct estimate){sum, sqrt(variance / SEEDS)};
}

// `samples` for the weighted estimator; the others get `more` times as many.
static void check_agreement(const char *name, const struct scene *scene,
                            const struct reference_params *params, uint32_t samples,
                            const uint32_t more[2])
{
    struct estimate weighted = estimate(scene, *params, REFERENCE_MIS, samples);
    struct estimate others[2] = {
        estimate(scene, *params, REFERENCE_LIGHT_SAMPLING, samples * more[0]),
        estimate(scene, *params, REFERENCE_BSDF_SAMPLING, samples * more[1])};
    print_message("  %-16s weighted %.5g (+- %.2f %%)  by lights %+.2f %% (+- %.2f)  "
                  "by surfaces %+.2f %% (+- %.2f)\n",
                  name, weighted.mean, 100.0 * weighted.standard_error / weighted.mean,
                  100.0 * (others[0].mean / weighted.mean - 1.0),
                  100.0 * others[0].standard_error / weighted.mean,
                  100.0 * (others[1].mean / weighted.mean - 1.0),
                  100.0 * others[1].standard_error / weighted.mean);
    assert_true(weighted.standard_error < 0.01 * weighted.mean);
    for (int i = 0; i < 2; i++) {
        double allowed = STANDARD_ERRORS * hypot(others[i].standard_error, weighted.standard_error);
        // If chance allowed much, nothing would be proved.
        assert_true(allowed < 0.1 * weighted.mean);
        assert_true(fabs(others[i].mean - weighted.mean) < allowed + 1e-4 * weighted.mean);
    }
    double allowed = STANDARD_ERRORS * hypot(others[0].standard_error, others[1].standard_error);
    assert_true(fabs(others[0].mean - others[1].mean) < allowed + 1e-4 * weighted.mean);
}

static void view_first_camera(const struct scene *scene, struct reference_params *params)
{
    scene_get_camera_placement(scene, 0, params->camera.eye, params->camera.target,
                               params->camera.up);
    params->camera.fov_y_rad = scene->cameras[0].fov_y_rad;
}

static void test_builtin_scenes(void **state)
{
    (void)state;
    static const struct {
        const char *source;
        uint32_t samples, more[2];
    } cases[] = {{"builtin:cornell", 32, {1, 8}}, {"builtin:material-grid", 32, {2, 4}}};
    for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
        struct error error = {""};
        struct scene *scene = scene_load(cases[i].source, &error);
        assert_non_null(scene);
        struct reference_params params = support_narrow_view((float[3]){0}, (float[3]){0, 0, 1});
        view_first_camera(scene, &params);
        params.width = params.height = 24;
        check_agreement(cases[i].source + strlen("builtin:"), scene, &params, cases[i].samples,
                        cases[i].more);
        scene_destroy(&scene);
    }
}

static uint32_t add_picture(struct scene *scene, const uint8_t rgba[4][4])
{
    uint8_t *bytes = malloc(16);
    assert_non_null(bytes);
    memcpy(bytes, rgba, 16);
    struct image *image = image_create(2, 2, bytes);
    assert_non_null(image);
    uint32_t id = scene_add_image(scene, image);
    image_release(&image);
    return id;
}

// A floor under an emitter whose texture glows most in one corner, seen by a rough metal as well.
static void test_textured_emitter(void **state)
{
    (void)state;
    struct scene *scene = support_scene_create();
    uint32_t floor = support_add_matte(scene, 0.7f);
    scene->materials[floor].ior = 1.5f;
    scene->materials[floor].roughness = 0.4f;
    support_add_floor(scene, floor, (float[2]){-2, -2}, (float[2]){2, 2}, 0.0f, false);
    uint32_t light = support_add_emissive(scene, 5.0f);
    const uint8_t texels[4][4] = {
        {255, 60, 60, 255}, {30, 255, 30, 255}, {0, 0, 0, 255}, {90, 90, 255, 255}};
    scene->materials[light].textures[SCENE_TEXTURE_EMISSIVE].image = add_picture(scene, texels);
    scene->materials[light].double_sided = true;
    support_add_floor(scene, light, (float[2]){-1, -1}, (float[2]){1, 1}, 1.0f, true);
    struct reference_params params =
        support_narrow_view((float[3]){0.5f, -4, 3}, (float[3]){0, 0, 0.2f});
    params.camera.fov_y_rad = 0.7f;
    check_agreement("textured emitter", scene, &params, 32, (uint32_t[2]){2, 2});
    scene_destroy(&scene);
}

// A sky with a small sun in it, over a box on a floor.
static void test_environment_picture(void **state)
{
    (void)state;
    struct scene *scene = support_scene_create();
    uint32_t floor = support_add_matte(scene, 0.6f);
    support_add_floor(scene, floor, (float[2]){-3, -3}, (float[2]){3, 3}, 0.0f, false);
    uint32_t specular = support_add_matte(scene, 0.3f);
    scene->materials[specular].ior = 1.5f;
    scene->materials[specular].roughness = 0.3f;
    support_add_box(scene, specular, (float[3]){-0.5f, -0.5f, 0}, (float[3]){0.5f, 0.5f, 1});
    struct scene_environment sky = {
        .type = SCENE_ENVIRONMENT_EQUIRECT, .intensity = 2.0f, .rotation_rad = 0.7f};
    float *pixels = calloc(32 * 16, 3 * sizeof(float));
    assert_non_null(pixels);
    for (int i = 0; i < 32 * 16; i++)
        for (int c = 0; c < 3; c++)
            pixels[3 * i + c] = i == 7 * 32 + 12 ? 60.0f : 0.2f + 0.1f * (float)c;
    sky.image = environment_image_create(32, 16, pixels);
    assert_non_null(sky.image);
    scene_set_environment(scene, &sky);
    struct reference_params params =
        support_narrow_view((float[3]){1.5f, -4, 3}, (float[3]){0, 0, 0.3f});
    params.camera.fov_y_rad = 0.7f;
    check_agreement("sky with a sun", scene, &params, 32, (uint32_t[2]){1, 4});
    scene_destroy(&scene);
}

// A light within frosted glass over a floor: all its light is refracted twice.
static void test_frosted_glass(void **state)
{
    (void)state;
    struct scene *scene = support_scene_create();
    uint32_t floor = support_add_matte(scene, 0.6f);
    support_add_floor(scene, floor, (float[2]){-2, -2}, (float[2]){2, 2}, 0.0f, false);
    uint32_t glass = support_add_glass(scene, 1.4f, 0.8f, 1.0f);
    scene->materials[glass].base_color[1] = 0.5f;
    scene->materials[glass].attenuation_distance_m = 1.0f;
    scene->materials[glass].attenuation_color[0] = 0.5f;
    support_add_box(scene, glass, (float[3]){-0.6f, -0.6f, 0.3f}, (float[3]){0.6f, 0.6f, 0.6f});
    uint32_t light = support_add_emissive(scene, 5.0f);
    support_add_floor(scene, light, (float[2]){-0.7f, -0.7f}, (float[2]){0.7f, 0.7f}, 1.0f, true);
    struct reference_params params =
        support_narrow_view((float[3]){1, -4, 2}, (float[3]){0, 0, 0.3f});
    params.camera.fov_y_rad = 0.5f;
    check_agreement("frosted glass", scene, &params, 256, (uint32_t[2]){2, 1});
    scene_destroy(&scene);
}

// Light of an emitter through a blended pane and a thin coloured one.
static void test_panes(void **state)
{
    (void)state;
    struct scene *scene = support_scene_create();
    uint32_t floor = support_add_matte(scene, 0.6f);
    support_add_floor(scene, floor, (float[2]){-2, -2}, (float[2]){2, 2}, 0.0f, false);
    uint32_t sheet = support_add_matte(scene, 0.8f);
    scene->materials[sheet].alpha_mode = SCENE_ALPHA_BLEND;
    scene->materials[sheet].base_color[3] = 0.4f;
    scene->materials[sheet].double_sided = true;
    support_add_floor(scene, sheet, (float[2]){-1, -1}, (float[2]){0.2f, 1}, 0.4f, false);
    uint32_t pane = support_add_glass(scene, 1.5f, 0.2f, 0.0f);
    scene->materials[pane].base_color[0] = 0.4f;
    scene->materials[pane].transmission = 0.8f;
    support_add_floor(scene, pane, (float[2]){-0.2f, -1}, (float[2]){1, 1}, 0.6f, false);
    uint32_t light = support_add_emissive(scene, 5.0f);
    support_add_floor(scene, light, (float[2]){-0.7f, -0.7f}, (float[2]){0.7f, 0.7f}, 1.0f, true);
    struct reference_params params =
        support_narrow_view((float[3]){1, -4, 2}, (float[3]){0, 0, 0.3f});
    params.camera.fov_y_rad = 0.6f;
    check_agreement("panes", scene, &params, 128, (uint32_t[2]){2, 1});
    scene_destroy(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_builtin_scenes),
        cmocka_unit_test(test_textured_emitter),
        cmocka_unit_test(test_environment_picture),
        cmocka_unit_test(test_frosted_glass),
        cmocka_unit_test(test_panes),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
