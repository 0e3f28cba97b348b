// Proves with closed formulas how the reference path tracer renders mirrors, refracting bodies,
// thin panes, coverage and lights with a size: all to 1 %.
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include <math.h>
#include <stdlib.h>

#include "support_reference.h"

#define RADIANCE 10.0f

static double schlick(double f0, double cosine)
{
    return f0 + (1.0 - f0) * pow(1.0 - cosine, 5.0);
}

static double mean_red(const struct scene *scene, const struct reference_params *params,
                       uint32_t samples, uint32_t layers)
{
    double mean[3];
    support_reference_mean(scene, params, samples, layers, mean);
    return mean[0];
}

// A smooth metal shows an emitter where the law of reflection puts it, and nothing beside it.
static void test_mirror(void **state)
{
    (void)state;
    struct scene *scene = support_scene_create();
    struct scene_material metal;
    scene_material_init(&metal, "metal");
    metal.roughness = 0.0f;
    metal.base_color[0] = 0.6f;
    uint32_t mirror = scene_add_material(scene, &metal);
    support_add_floor(scene, mirror, (float[2]){-5, -5}, (float[2]){5, 5}, 0.0f, false);
    uint32_t key_light = support_add_emissive(scene, RADIANCE);
    support_add_floor(scene, key_light, (float[2]){1.8f, -0.2f}, (float[2]){2.2f, 0.2f}, 2.0f,
                      true);
    // From (-3, 0, 3) by (0, 0, 0) to (2, 0, 2).
    struct reference_params params = support_narrow_view((float[3]){-3, 0, 3}, (float[3]){0, 0, 0});
    support_assert_ratio(mean_red(scene, &params, 64, REFERENCE_ALL_LAYERS),
                         RADIANCE * schlick(0.6, sqrt(0.5)), 0.01, "mirrored emitter");
    params.camera.target[0] = 0.5f;
    assert_true(mean_red(scene, &params, 64, REFERENCE_ALL_LAYERS) < 1e-4 * RADIANCE);
    scene_destroy(&scene);
}

#define SLAB_M     1.0f
#define SLAB_IOR   1.5
#define SLAB_ANGLE (M_PI / 4.0)
#define BELOW_M    3.0 // of the emitter, under the slab

// A slab of glass over an emitter that reaches from x = -50 to `edge`, seen at SLAB_ANGLE so that
// the middle of the view enters the slab in x = 0.
static struct scene *slab_scene(float edge, float attenuation, struct reference_params *out_params)
{
    struct scene *scene = support_scene_create();
    uint32_t glass = support_add_glass(scene, (float)SLAB_IOR, 0.0f, SLAB_M);
    scene->materials[glass].base_color[0] = 0.8f;
    scene->materials[glass].attenuation_distance_m = 0.5f;
    scene->materials[glass].attenuation_color[0] = attenuation;
    support_add_box(scene, glass, (float[3]){-50, -50, 0}, (float[3]){50, 50, SLAB_M});
    uint32_t key_light = support_add_emissive(scene, RADIANCE);
    support_add_floor(scene, key_light, (float[2]){-50, -50}, (float[2]){edge, 50}, -(float)BELOW_M,
                      false);
    float away = 10.0f;
    *out_params = support_narrow_view(
        (float[3]){-away * sinf((float)SLAB_ANGLE), 0, SLAB_M + away * cosf((float)SLAB_ANGLE)},
        (float[3]){0, 0, SLAB_M});
    return scene;
}

// The edge of the emitter appears where Snell's law puts it: half the view shows the emitter. An
// error of 1 % of the displacement is a tenth of the view.
static void test_refraction_by_snell(void **state)
{
    (void)state;
    struct reference_params params;
    double inside = asin(sin(SLAB_ANGLE) / SLAB_IOR);
    double edge = SLAB_M * tan(inside) + BELOW_M * tan(SLAB_ANGLE);
    double displacement = SLAB_M * (tan(SLAB_ANGLE) - tan(inside));
    struct scene *scene = slab_scene(40.0f, 1.0f, &params);
    uint32_t straight = REFERENCE_LAYER(REFERENCE_EMISSION);
    double all = mean_red(scene, &params, 64, straight);
    scene_destroy(&scene);
    double weights[3];
    for (int i = 0; i < 3; i++) {
        scene = slab_scene((float)(edge + (i - 1) * 0.01 * displacement), 1.0f, &params);
        // Wider than the blur by the microfacets of smooth glass.
        params.camera.fov_y_rad = 0.004f;
        weights[i] = mean_red(scene, &params, 256, straight) / all;
        print_message("  edge %+d %% of the displacement off: %.3f of the view shows it\n", i - 1,
                      weights[i]);
        scene_destroy(&scene);
    }
    assert_true(weights[0] < 0.5 && weights[2] > 0.5 && fabs(weights[1] - 0.5) < 0.02);
}

// What a slab lets through: Fresnel at both of its sides, tint once, Beer's law along the refracted
// path, and all inner reflections as a geometric series.
static void test_absorption_through_a_slab(void **state)
{
    (void)state;
    static const float attenuations[] = {1.0f, 0.7f, 0.3f};
    double cosine_inside = sqrt(1.0 - pow(sin(SLAB_ANGLE) / SLAB_IOR, 2.0));
    double fresnel = schlick(0.04, cos(SLAB_ANGLE));
    for (int i = 0; i < 3; i++) {
        struct reference_params params;
        struct scene *scene = slab_scene(40.0f, attenuations[i], &params);
        double left = pow(attenuations[i], SLAB_M / cosine_inside / 0.5);
        double once = RADIANCE * 0.8 * (1.0 - fresnel) * (1.0 - fresnel) * left;
        support_assert_ratio(mean_red(scene, &params, 256, REFERENCE_LAYER(REFERENCE_EMISSION)),
                             once, 0.01, "slab, straight");
        support_assert_ratio(mean_red(scene, &params, 512, REFERENCE_ALL_LAYERS),
                             once / (1.0 - fresnel * fresnel * left * left), 0.01,
                             "slab, all reflections");
        scene_destroy(&scene);
    }
}

// A prism turns light by a right angle: its long side lets nothing out.
static void test_total_internal_reflection(void **state)
{
    (void)state;
    struct scene *scene = support_scene_create();
    uint32_t glass = support_add_glass(scene, 1.5f, 0.0f, 1.0f);
    const float sides[3][4][3] = {
        {{0, 0, -2}, {0, 0, 2}, {0, 1, 2}, {0, 1, -2}},
        {{0, 0, -2}, {1, 0, -2}, {1, 0, 2}, {0, 0, 2}},
        {{1, 0, -2}, {0, 1, -2}, {0, 1, 2}, {1, 0, 2}},
    };
    for (int i = 0; i < 3; i++)
        support_add_quad(scene, glass, sides[i]);
    uint32_t below = support_add_emissive(scene, RADIANCE);
    const float floor[4][3] = {{-9, -1, -9}, {-9, -1, 9}, {9, -1, 9}, {9, -1, -9}};
    support_add_quad(scene, below, floor);
    uint32_t behind = support_add_emissive(scene, RADIANCE);
    scene->materials[behind].emissive[0] = 0.0f; // cyan
    const float wall[4][3] = {{5, -0.9f, -9}, {5, -0.9f, 9}, {5, 9, 9}, {5, 9, -9}};
    support_add_quad(scene, behind, wall);
    struct reference_params params =
        support_narrow_view((float[3]){-5, 0.3f, 0}, (float[3]){0, 0.3f, 0});
    double mean[3];
    support_reference_mean(scene, &params, 1024, REFERENCE_ALL_LAYERS, mean);
    // Out through the base, or back by it and out where it came from, and so on.
    support_assert_ratio(mean[0], RADIANCE * 0.96 * 0.96 / (1.0 - 0.04 * 0.04), 0.01, "prism");
    support_assert_ratio(mean[1], mean[0], 1e-3, "of which from behind the long side: none");
    scene_destroy(&scene);
}

// In uniform light a clear body cannot be seen.
static void test_glass_vanishes_in_a_furnace(void **state)
{
    (void)state;
    static const float roughnesses[] = {0.0f, 0.2f, 0.5f};
    for (int i = 0; i < 3; i++) {
        struct scene *scene = support_scene_create();
        scene->environment.type = SCENE_ENVIRONMENT_CONSTANT;
        uint32_t glass = support_add_glass(scene, 1.4f, roughnesses[i], 1.0f);
        support_add_box(scene, glass, (float[3]){-1, -1, -1}, (float[3]){1, 1, 1});
        struct reference_params params =
            support_narrow_view((float[3]){2, 1.5f, 4}, (float[3]){0.1f, 0.2f, 0});
        // Light that would leave a rough surface only after a second bounce on it is lost, as in
        // the model of glTF.
        static const double tolerances[] = {0.002, 0.01, 0.1};
        support_assert_ratio(mean_red(scene, &params, 256, REFERENCE_ALL_LAYERS), 1.0,
                             tolerances[i], "glass in a furnace");
        scene_destroy(&scene);
    }
}

// A thin pane: seen by the camera, and as a coloured shadow.
static void test_thin_panes_tint(void **state)
{
    (void)state;
    struct scene *scene = support_scene_create();
    uint32_t pane = support_add_glass(scene, 1.5f, 0.3f, 0.0f);
    scene->materials[pane].base_color[0] = 0.5f;
    support_add_floor(scene, pane, (float[2]){-9, -9}, (float[2]){9, 9}, 1.0f, false);
    uint32_t key_light = support_add_emissive(scene, RADIANCE);
    support_add_floor(scene, key_light, (float[2]){-1, -1}, (float[2]){1, 1}, 0.0f, false);
    struct reference_params params = support_narrow_view((float[3]){0, 0, 3}, (float[3]){0});
    support_assert_ratio(mean_red(scene, &params, 256, REFERENCE_LAYER(REFERENCE_EMISSION)),
                         RADIANCE * 0.5 * 0.96, 0.01, "emitter through a pane");
    scene_destroy(&scene);

    scene = support_scene_create();
    pane = support_add_glass(scene, 1.5f, 0.3f, 0.0f);
    scene->materials[pane].base_color[0] = 0.5f;
    scene->materials[pane].transmission = 0.7f;
    support_add_floor(scene, pane, (float[2]){-9, -9}, (float[2]){9, 9}, 1.0f, false);
    uint32_t floor = support_add_matte(scene, 0.6f);
    support_add_floor(scene, floor, (float[2]){-1, -1}, (float[2]){1, 1}, 0.0f, false);
    struct scene_light light;
    scene_light_init(&light, SCENE_LIGHT_POINT, "lamp");
    light.intensity = 20.0f;
    scene_add_light(scene, &light, (float[3]){0, 0, 2}, (float[3]){0, 0, -1});
    params = support_narrow_view((float[3]){0.2f, 0, 0.5f}, (float[3]){0, 0, 0});
    params.max_bounces = 0;
    support_assert_ratio(mean_red(scene, &params, 64, REFERENCE_ALL_LAYERS),
                         0.6 / M_PI * 20.0 / 4.0 * 0.5 * 0.96 * 0.7, 0.01, "shadow of a pane");
    scene_destroy(&scene);
}

// A blended sheet shows its own light by its alpha and what is behind by the rest; so does light
// that passes through it.
static void test_coverage(void **state)
{
    (void)state;
    struct scene *scene = support_scene_create();
    uint32_t sheet = support_add_emissive(scene, RADIANCE);
    scene->materials[sheet].alpha_mode = SCENE_ALPHA_BLEND;
    scene->materials[sheet].base_color[3] = 0.3f;
    support_add_floor(scene, sheet, (float[2]){-9, -9}, (float[2]){9, 9}, 1.0f, false);
    uint32_t key_light = support_add_emissive(scene, 4.0f);
    support_add_floor(scene, key_light, (float[2]){-1, -1}, (float[2]){1, 1}, 0.0f, false);
    struct reference_params params = support_narrow_view((float[3]){0, 0, 3}, (float[3]){0});
    support_assert_ratio(mean_red(scene, &params, 256, REFERENCE_ALL_LAYERS),
                         0.3 * RADIANCE + 0.7 * 4.0, 0.01, "emitter behind a blended one");
    scene_destroy(&scene);

    scene = support_scene_create();
    sheet = support_add_matte(scene, 0.0f);
    scene->materials[sheet].alpha_mode = SCENE_ALPHA_BLEND;
    scene->materials[sheet].base_color[3] = 0.3f;
    support_add_floor(scene, sheet, (float[2]){-9, -9}, (float[2]){9, 9}, 1.0f, false);
    uint32_t floor = support_add_matte(scene, 0.6f);
    support_add_floor(scene, floor, (float[2]){-1, -1}, (float[2]){1, 1}, 0.0f, false);
    scene->environment.type = SCENE_ENVIRONMENT_CONSTANT;
    params = support_narrow_view((float[3]){0.2f, 0, 0.5f}, (float[3]){0, 0, 0});
    static const enum reference_estimator estimators[] = {REFERENCE_MIS, REFERENCE_LIGHT_SAMPLING,
                                                          REFERENCE_BSDF_SAMPLING};
    for (int i = 0; i < 3; i++) {
        params.estimator = estimators[i];
        support_assert_ratio(mean_red(scene, &params, 512, REFERENCE_LAYER(REFERENCE_SKY)),
                             0.6 * (0.7 + 0.3 * 0.0), 0.015, "sky through a blended sheet");
    }
    scene_destroy(&scene);
}

// A light with a size gives a surface that faces it what a point light would, and half of that
// where an edge hides half of it.
static void test_lights_of_a_size(void **state)
{
    (void)state;
    for (int hidden = 0; hidden < 2; hidden++) {
        struct scene *scene = support_scene_create();
        uint32_t floor = support_add_matte(scene, 0.6f);
        support_add_floor(scene, floor, (float[2]){-1, -1}, (float[2]){1, 1}, 0.0f, false);
        if (hidden)
            support_add_floor(scene, floor, (float[2]){0, -9}, (float[2]){9, 9}, 1.0f, false);
        struct scene_light light;
        scene_light_init(&light, SCENE_LIGHT_POINT, "ball");
        light.intensity = 20.0f;
        light.radius_m = 0.5f;
        scene_add_light(scene, &light, (float[3]){0, 0, 2}, (float[3]){0, 0, -1});
        struct reference_params params =
            support_narrow_view((float[3]){-0.2f, 0, 0.5f}, (float[3]){0, 0, 0});
        params.max_bounces = 0;
        params.camera.fov_y_rad = 0.001f;
        support_assert_ratio(mean_red(scene, &params, 256, REFERENCE_ALL_LAYERS),
                             0.6 / M_PI * 20.0 / 4.0 * (hidden ? 0.5 : 1.0), 0.01,
                             hidden ? "half of a ball" : "ball of light");
        scene_destroy(&scene);
    }
}

// Blinn-Phong as the shaders have it, for a light and a viewer over a white surface.
static void test_blinn_phong(void **state)
{
    (void)state;
    struct scene *scene = support_scene_create();
    struct scene_material specular;
    scene_material_init(&specular, "gloss");
    specular.shading = SCENE_SHADING_BLINN_PHONG;
    specular.metallic = 0.0f;
    specular.roughness = 0.5f;
    specular.ior = 0.0f; // reflects everything
    uint32_t material = scene_add_material(scene, &specular);
    support_add_floor(scene, material, (float[2]){-1, -1}, (float[2]){1, 1}, 0.0f, false);
    struct scene_light light;
    scene_light_init(&light, SCENE_LIGHT_DIRECTIONAL, "sun");
    light.intensity = 3.0f;
    scene_add_light(scene, &light, (float[3]){0}, (float[3]){0.6f, 0, -0.8f});
    struct reference_params params = support_narrow_view((float[3]){0, 0, 3}, (float[3]){0});
    // Half vector of (-0.6, 0, 0.8) and (0, 0, 1): its cosine is sqrt((1 + 0.8) / 2).
    double exponent = 2.0 / pow(0.5, 4.0) - 2.0;
    double expected = 3.0 * (exponent + 8.0) / (8.0 * M_PI) * pow(sqrt(0.9), exponent) * 0.8;
    support_assert_ratio(mean_red(scene, &params, 16, REFERENCE_ALL_LAYERS), expected, 0.001,
                         "Blinn-Phong under a sun");
    // Sampled, it integrates to the same as aimed at.
    scene->lights[0].enabled = false;
    scene->environment.type = SCENE_ENVIRONMENT_CONSTANT;
    double means[2];
    for (int i = 0; i < 2; i++) {
        params.estimator = i ? REFERENCE_BSDF_SAMPLING : REFERENCE_LIGHT_SAMPLING;
        means[i] = mean_red(scene, &params, 1024, REFERENCE_ALL_LAYERS);
    }
    support_assert_ratio(means[0], means[1], 0.01, "Blinn-Phong under a sky, both ways");
    scene_destroy(&scene);
}

// A mirror reflects a point light's light onto a floor as if there were a second point behind it:
// chance would hardly ever find that path. The more samples, the less it is blurred.
static void test_caustic_of_a_point(void **state)
{
    (void)state;
    struct scene *scene = support_scene_create();
    uint32_t floor = support_add_matte(scene, 0.6f);
    support_add_floor(scene, floor, (float[2]){-0.01f, -0.01f}, (float[2]){0.01f, 0.01f}, 0.0f,
                      false);
    struct scene_material metal;
    scene_material_init(&metal, "mirror");
    metal.roughness = 0.0f;
    uint32_t mirror = scene_add_material(scene, &metal);
    const float wall[4][3] = {{1, -9, -9}, {1, -9, 9}, {1, 9, 9}, {1, 9, -9}};
    support_add_quad(scene, mirror, wall);
    struct scene_light light;
    scene_light_init(&light, SCENE_LIGHT_POINT, "lamp");
    light.intensity = 20.0f;
    scene_add_light(scene, &light, (float[3]){0, 0, 1}, (float[3]){0, 0, -1});
    struct reference_params params =
        support_narrow_view((float[3]){-0.5f, 0, 1}, (float[3]){0, 0, 0});
    uint32_t layer = REFERENCE_LAYER(REFERENCE_FIRST_BOUNCE);
    support_assert_ratio(mean_red(scene, &params, 2048, layer), 0.6 / M_PI * 20.0 / 5.0 / sqrt(5.0),
                         0.02, "mirrored point");
    scene_destroy(&scene);
}

// Many lights over a floor give the sum of what each gives: lights with a range through the grid
// that knows which ones reach a point, very many without a range through candidates.
static void test_many_lights_sum_up(void **state)
{
    (void)state;
    static const struct {
        uint32_t count;
        float range_m;
    } cases[] = {{100, 0.0f}, {400, 1.7f}, {2000, 0.0f}};
    for (int i = 0; i < 3; i++) {
        struct scene *scene = support_scene_create();
        uint32_t floor = support_add_matte(scene, 0.6f);
        support_add_floor(scene, floor, (float[2]){-5, -5}, (float[2]){5, 5}, 0.0f, false);
        uint32_t edge = (uint32_t)ceil(sqrt((double)cases[i].count));
        double expected = 0.0;
        for (uint32_t j = 0; j < cases[i].count; j++) {
            struct scene_light light;
            scene_light_init(&light, SCENE_LIGHT_POINT, "lamp");
            light.intensity = 1.0f + (float)(j % 7);
            light.range_m = cases[i].range_m;
            float x = 9.0f * ((float)(j % edge) / (float)edge - 0.5f) + 0.3f;
            float y = 9.0f * ((float)(j / edge) / (float)edge - 0.5f) + 0.2f;
            scene_add_light(scene, &light, (float[3]){x, y, 1}, (float[3]){0, 0, -1});
            double squared = (double)x * x + (double)y * y + 1.0;
            double ratio =
                cases[i].range_m > 0.0f ? squared / pow((double)cases[i].range_m, 2.0) : 0.0;
            expected += 0.6 / M_PI * light.intensity * fmax(1.0 - ratio * ratio, 0.0) /
                        (squared * sqrt(squared));
        }
        struct reference_params params =
            support_narrow_view((float[3]){0, 0, 0.9f}, (float[3]){0, 0, 0});
        params.max_bounces = 0;
        support_assert_ratio(mean_red(scene, &params, 1024, REFERENCE_ALL_LAYERS), expected, 0.01,
                             "many lamps");
        scene_destroy(&scene);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_mirror),
        cmocka_unit_test(test_refraction_by_snell),
        cmocka_unit_test(test_absorption_through_a_slab),
        cmocka_unit_test(test_total_internal_reflection),
        cmocka_unit_test(test_glass_vanishes_in_a_furnace),
        cmocka_unit_test(test_thin_panes_tint),
        cmocka_unit_test(test_coverage),
        cmocka_unit_test(test_lights_of_a_size),
        cmocka_unit_test(test_blinn_phong),
        cmocka_unit_test(test_caustic_of_a_point),
        cmocka_unit_test(test_many_lights_sum_up),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
