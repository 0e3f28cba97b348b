// Proves that direct light is exact in physical units: renders a matte square under each kind of
// light into linear radiance and compares with the closed formula, within 0.5 %.
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "support_gpu.h"

#define TOLERANCE 0.005

static void assert_close(double measured, double expected, const char *what)
{
    if (!(fabs(measured - expected) <= TOLERANCE * fabs(expected)))
        fail_msg("%s: %.9g, expected %.9g", what, measured, expected);
}

// Radiance at the square's centre, seen from distance `eye`.
static float measure(struct scene *scene, float eye)
{
    struct frame_params params = test_params(33, 33, FRAME_OUTPUT_LINEAR);
    params.camera.fov_y_rad = 0.02f; // only the centre matters
    test_look_down_z(&params, eye);
    struct test_picture picture = test_draw_linear(scene, &params);
    float value = test_center(&picture);
    free(picture.pixels);
    return value;
}

static void test_point_light_follows_the_inverse_square(void **state)
{
    (void)state;
    static const float distances_m[] = {0.01f, 0.1f, 1.0f, 10.0f, 100.0f, 1000.0f};
    static const float albedos[] = {0.05f, 0.18f, 0.9f};
    for (size_t i = 0; i < sizeof(distances_m) / sizeof(distances_m[0]); i++)
        for (size_t j = 0; j < sizeof(albedos) / sizeof(albedos[0]); j++) {
            float d = distances_m[i];
            struct scene *scene = test_square_scene(0.5f * d, albedos[j]);
            struct scene_light light;
            scene_light_init(&light, SCENE_LIGHT_POINT, "lamp");
            light.intensity = 20.0f;
            scene_add_light(scene, &light, (float[3]){0, 0, d}, (float[3]){0, 0, -1});
            // Seen past the light, which has no body.
            assert_close(measure(scene, 2.0f * d), albedos[j] / M_PI * 20.0 / ((double)d * d),
                         "point light");
            scene_destroy(&scene);
        }
}

static void test_directional_light_gives_its_illuminance(void **state)
{
    (void)state;
    struct scene *scene = test_square_scene(1.0f, 0.5f);
    struct scene_light light;
    scene_light_init(&light, SCENE_LIGHT_DIRECTIONAL, "sun");
    light.intensity = 80000.0f;
    scene_add_light(scene, &light, (float[3]){0, 0, 5}, (float[3]){0, 0, -1});
    assert_close(measure(scene, 4.0f), 0.5 / M_PI * 80000.0, "directional light");
    // At 60 degrees half of it.
    scene_set_light_placement(scene, 0, (float[3]){0, 0, 5},
                              (float[3]){sinf((float)M_PI / 3), 0, -0.5f});
    assert_close(measure(scene, 4.0f), 0.25 / M_PI * 80000.0, "directional light at 60 degrees");
    scene_destroy(&scene);
}

static void test_spot_follows_its_cone(void **state)
{
    (void)state;
    const double inner = 0.3, outer = 0.7;
    static const double angles[] = {0.0, 0.2, 0.4, 0.5, 0.65, 0.8};
    for (size_t i = 0; i < sizeof(angles) / sizeof(angles[0]); i++) {
        struct scene *scene = test_square_scene(1.0f, 0.6f);
        struct scene_light light;
        scene_light_init(&light, SCENE_LIGHT_SPOT, "spot");
        light.intensity = 7.0f;
        light.inner_cone_rad = (float)inner;
        light.outer_cone_rad = (float)outer;
        // The light stays in front of the centre and turns away from it.
        scene_add_light(scene, &light, (float[3]){0, 0, 2},
                        (float[3]){(float)sin(angles[i]), 0, -(float)cos(angles[i])});
        double scale = 1.0 / fmax(0.001, cos(inner) - cos(outer));
        double angular = fmin(fmax((cos(angles[i]) - cos(outer)) * scale, 0.0), 1.0);
        double expected = 0.6 / M_PI * 7.0 / 4.0 * angular * angular;
        float value = measure(scene, 3.0f);
        if (expected == 0.0)
            assert_true(value == 0.0f);
        else
            assert_close(value, expected, "spot");
        scene_destroy(&scene);
    }
}

static void test_range_ends_as_the_extension_says(void **state)
{
    (void)state;
    struct scene *scene = test_square_scene(1.0f, 0.6f);
    struct scene_light light;
    scene_light_init(&light, SCENE_LIGHT_POINT, "lamp");
    light.intensity = 9.0f;
    light.range_m = 4.0f;
    scene_add_light(scene, &light, (float[3]){0, 0, 3}, (float[3]){0, 0, -1});
    double window = 1.0 - pow(3.0 / 4.0, 4.0);
    assert_close(measure(scene, 3.5f), 0.6 / M_PI * 9.0 / 9.0 * window, "ranged light");
    scene_set_light_placement(scene, 0, (float[3]){0, 0, 4.01f}, (float[3]){0, 0, -1});
    assert_true(measure(scene, 3.5f) == 0.0f);
    scene_destroy(&scene);
}

static void test_emission_is_radiance(void **state)
{
    (void)state;
    static const float radiances[] = {0.01f, 1.0f, 17.0f, 5000.0f};
    for (size_t i = 0; i < sizeof(radiances) / sizeof(radiances[0]); i++) {
        struct scene *scene = test_square_scene(1.0f, 0.0f);
        struct scene_material material = scene->materials[0];
        material.emissive[0] = material.emissive[1] = material.emissive[2] = 1.0f;
        material.emissive_strength = radiances[i];
        scene_set_material(scene, 0, &material);
        assert_close(measure(scene, 3.0f), radiances[i], "emission");
        scene_destroy(&scene);
    }
}

// A disk-like square emitter of radiance L parallel to the receiver: the form factor of a parallel
// square of half-edge h at distance d, seen from a point on its axis, is
// 4 / (2 pi) * 2 * X / sqrt(1 + X^2) * atan(X / sqrt(1 + X^2)) with X = h / d.
static void test_emitter_lights_by_its_form_factor(void **state)
{
    (void)state;
    const double half = 0.5, distance = 1.0;
    struct scene *scene = test_square_scene(2.0f, 0.5f);
    struct scene_material key_light = scene->materials[0];
    strcpy(key_light.name, "lamp");
    key_light.emissive[0] = key_light.emissive[1] = key_light.emissive[2] = 1.0f;
    key_light.emissive_strength = 10.0f;
    uint32_t material = scene_add_material(scene, &key_light);
    struct scene_vertex vertices[4] = {0};
    for (int i = 0; i < 4; i++) {
        vertices[i].position[0] = (float)(i == 1 || i == 2 ? half : -half);
        vertices[i].position[1] = (float)(i >= 2 ? -half : half); // faces -Z
        vertices[i].position[2] = (float)distance;
        vertices[i].normal[2] = -1.0f;
        for (int c = 0; c < 4; c++)
            vertices[i].color[c] = 1.0f;
    }
    uint32_t mesh = scene_add_mesh(scene, "lamp");
    const uint32_t indices[6] = {0, 1, 2, 0, 2, 3};
    scene_add_primitive(scene, vertices, 4, indices, 6, material);
    uint32_t node = scene_add_node(scene, "lamp", SCENE_NONE);
    scene->nodes[node].mesh = mesh;
    scene_update_world_transforms(scene);

    double x = half / distance, root = sqrt(1.0 + x * x);
    double form_factor = 4.0 / (2.0 * M_PI) * 2.0 * x / root * atan(x / root);
    // The light shows the camera its unlit back and is culled.
    assert_close(measure(scene, 3.0f), 0.5 * 10.0 * form_factor, "planar emitter");
    scene_destroy(&scene);
}

// A metal floor reflects a wide bright wall, seen at ever lower angles.
static void test_reflection_is_never_brighter_than_its_source(void **state)
{
    (void)state;
    struct scene *scene = test_square_scene(10.0f, 1.0f);
    struct scene_material floor = scene->materials[0];
    floor.metallic = 1.0f;
    floor.roughness = 0.15f;
    scene_set_material(scene, 0, &floor);
    struct scene_material wall = scene->materials[0];
    wall.base_color[0] = wall.base_color[1] = wall.base_color[2] = 0.0f;
    wall.emissive[0] = wall.emissive[1] = wall.emissive[2] = 1.0f;
    uint32_t material = scene_add_material(scene, &wall);
    const float corners[4][3] = {{-4, 6, 0}, {4, 6, 0}, {4, 6, 5}, {-4, 6, 5}};
    struct scene_vertex vertices[4] = {0};
    for (int i = 0; i < 4; i++) {
        memcpy(vertices[i].position, corners[i], sizeof(corners[i]));
        vertices[i].normal[1] = -1.0f;
        for (int c = 0; c < 4; c++)
            vertices[i].color[c] = 1.0f;
    }
    const uint32_t indices[6] = {0, 1, 2, 0, 2, 3};
    uint32_t mesh = scene_add_mesh(scene, "wall");
    scene_add_primitive(scene, vertices, 4, indices, 6, material);
    uint32_t node = scene_add_node(scene, "wall", SCENE_NONE);
    scene->nodes[node].mesh = mesh;
    scene_update_world_transforms(scene);

    static const float heights_m[] = {0.3f, 1.0f, 3.0f};
    for (size_t i = 0; i < sizeof(heights_m) / sizeof(heights_m[0]); i++) {
        struct frame_params params = test_params(48, 32, FRAME_OUTPUT_LINEAR);
        params.camera = (struct view_camera){.eye = {0, -8, heights_m[i]},
                                             .target = {0, 6, 0.5f},
                                             .up = {0, 0, 1},
                                             .fov_y_rad = 0.5f};
        struct test_picture picture = test_draw_linear(scene, &params);
        float brightest = 0.0f;
        for (size_t pixel = 0; pixel < (size_t)48 * 32; pixel++)
            brightest = fmaxf(brightest, picture.pixels[4 * pixel]);
        free(picture.pixels);
        assert_close(brightest, 1.0, "brightest of wall and reflection");
    }
    scene_destroy(&scene);
}

// Under a sky of luminance 1 a white metal shows the directional albedo of its lobe: values by
// numerical integration of the formulas of glTF 2.0, appendix B, seen head on.
static void test_metal_under_a_sky_shows_its_albedo(void **state)
{
    (void)state;
    static const double albedos[][2] = {{0.0, 1.0},   {0.2, 0.998}, {0.4, 0.968},
                                        {0.6, 0.825}, {0.8, 0.555}, {1.0, 0.307}};
    for (size_t i = 0; i < sizeof(albedos) / sizeof(albedos[0]); i++) {
        struct scene *scene = test_square_scene(1.0f, 1.0f);
        struct scene_material material = scene->materials[0];
        material.metallic = 1.0f;
        material.roughness = (float)albedos[i][0];
        scene_set_material(scene, 0, &material);
        scene->environment.type = SCENE_ENVIRONMENT_CONSTANT;
        scene->environment.intensity = 1.0f;
        for (int c = 0; c < 3; c++)
            scene->environment.color[c] = 1.0f;
        double value = measure(scene, 3.0f);
        if (fabs(value - albedos[i][1]) > 0.01)
            fail_msg("roughness %g: %g, expected %g", albedos[i][0], value, albedos[i][1]);
        scene_destroy(&scene);
    }
}

static void test_a_thousand_lights_add_up(void **state)
{
    (void)state;
    struct scene *scene = test_square_scene(1.0f, 0.5f);
    struct scene_light light;
    scene_light_init(&light, SCENE_LIGHT_POINT, "lamp");
    light.intensity = 0.01f;
    light.casts_shadow = false;
    for (int i = 0; i < 1000; i++) {
        light.range_m = i % 2 ? 100.0f : 0.0f; // half of them go through the tiles' spheres
        scene_add_light(scene, &light, (float[3]){0, 0, 2}, (float[3]){0, 0, -1});
    }
    assert_close(measure(scene, 3.0f), 0.5 / M_PI * 1000 * 0.01 / 4.0, "a thousand lights");
    scene_destroy(&scene);
}

static void test_shadow_blocks_all_light(void **state)
{
    (void)state;
    static const enum scene_light_type types[] = {SCENE_LIGHT_DIRECTIONAL, SCENE_LIGHT_POINT,
                                                  SCENE_LIGHT_SPOT};
    for (int i = 0; i < 3; i++) {
        struct scene *scene = test_square_scene(1.0f, 0.5f);
        // The same square again, smaller, between light and receiver but out of the camera's view
        // of it.
        uint32_t node = scene_add_node(scene, "blocker", SCENE_NONE);
        scene->nodes[node].mesh = 0;
        scene_set_node_transform(scene, node, (float[3]){0.5f, 0, 0.5f}, (float[4]){0, 0, 0, 1},
                                 (float[3]){0.3f, 0.3f, 1.0f});
        struct scene_light light;
        scene_light_init(&light, types[i], "light");
        light.intensity = 10.0f;
        float position[3] = {1.0f, 0.0f, 1.0f}, direction[3] = {-1.0f, 0.0f, -1.0f};
        scene_add_light(scene, &light, position, direction);
        assert_true(measure(scene, 3.0f) < 1e-6f);
        scene_set_node_visible(scene, node, false);
        assert_true(measure(scene, 3.0f) > 0.1f);
        scene_destroy(&scene);
    }
}

// A plate of 4 cm, 3 cm above a floor of 60 m, like the eaves and ledges of a building. The sun's
// cascades resolve it, so the bias against acne must be measured in their texels.
static void test_small_things_cast_shadows_in_large_scenes(void **state)
{
    (void)state;
    struct scene *scene = test_square_scene(30.0f, 0.5f);
    uint32_t node = scene_add_node(scene, "plate", SCENE_NONE);
    scene->nodes[node].mesh = 0;
    const float size = 0.02f / 30.0f;
    scene_set_node_transform(scene, node, (float[3]){0.03f, 0, 0.03f}, (float[4]){0, 0, 0, 1},
                             (float[3]){size, size, 1.0f});
    struct scene_light light;
    scene_light_init(&light, SCENE_LIGHT_DIRECTIONAL, "sun");
    light.intensity = 10.0f;
    scene_add_light(scene, &light, (float[3]){0, 0, 5}, (float[3]){-1, 0, -1});
    struct frame_params params = test_params(33, 33, FRAME_OUTPUT_LINEAR);
    params.quality = QUALITY_FINAL;
    params.camera.fov_y_rad = 0.002f;
    test_look_down_z(&params, 1.0f);
    for (int visible = 0; visible < 2; visible++) {
        scene_set_node_visible(scene, node, visible);
        struct test_picture picture = test_draw_linear(scene, &params);
        double lit = test_center(&picture) / (0.5 / M_PI * 10.0 * sqrt(0.5));
        free(picture.pixels);
        assert_true(visible ? lit < 0.01 : fabs(lit - 1.0) < TOLERANCE);
    }
    scene_destroy(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_point_light_follows_the_inverse_square),
        cmocka_unit_test(test_directional_light_gives_its_illuminance),
        cmocka_unit_test(test_spot_follows_its_cone),
        cmocka_unit_test(test_range_ends_as_the_extension_says),
        cmocka_unit_test(test_emission_is_radiance),
        cmocka_unit_test(test_emitter_lights_by_its_form_factor),
        cmocka_unit_test(test_reflection_is_never_brighter_than_its_source),
        cmocka_unit_test(test_metal_under_a_sky_shows_its_albedo),
        cmocka_unit_test(test_a_thousand_lights_add_up),
        cmocka_unit_test(test_shadow_blocks_all_light),
        cmocka_unit_test(test_small_things_cast_shadows_in_large_scenes),
    };
    return cmocka_run_group_tests(tests, NULL, test_renderer_teardown);
}
