// Proves the reference path tracer by closed formulas, and that it and the renderer agree about
// units, camera and direct light.
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#include "renderer/import/builtin/builtin.h"
#include "renderer/import/scene_load.h"
#include "support_gi.h"
#include "support_gi_scenes.h"

enum layer { DIRECT, SKY, INDIRECT, TOTAL };

static struct path_params path_params(const struct scene *scene, uint32_t samples)
{
    return (struct path_params){
        .scene = scene,
        .camera = {.eye = {0.0f, 0.0f, 3.0f}, .up = {0.0f, 1.0f, 0.0f}, .fov_y_rad = 0.01f},
        .width = 16,
        .height = 16,
        .samples = samples,
        .bounces = PATH_BOUNCES_UNLIMITED,
        .seed = 7,
    };
}

// Mean of the red channel over the image.
static double trace_mean(const struct path_params *params, enum layer layer)
{
    struct path_picture picture;
    assert_true(path_trace(params, &picture));
    const float *const layers[3] = {picture.direct, picture.sky, picture.indirect};
    double sum = 0.0;
    for (int i = 0; i < 3; i++) {
        double rgb[3];
        gi_mean(layers[i], picture.width, picture.height, rgb);
        sum += i == (int)layer || layer == TOTAL ? rgb[0] : 0.0;
    }
    path_picture_finish(&picture);
    return sum;
}

static void test_punctual_lights_follow_their_formulas(void **state)
{
    (void)state;
    struct gi_report report = {0};
    struct scene *scene = test_square_scene(1.0f, 0.6f);
    struct scene_light light;
    scene_light_init(&light, SCENE_LIGHT_POINT, "lamp");
    light.intensity = 20.0f;
    scene_add_light(scene, &light, (float[3]){0, 0, 2}, (float[3]){0, 0, -1});
    struct path_params params = path_params(scene, 1);
    double expected = 0.6 / M_PI * 20.0 / 4.0;
    gi_check_ratio(&report, trace_mean(&params, DIRECT), expected, 1e-4, "point light");

    light = scene->lights[0];
    light.range_m = 3.0f;
    scene_set_light(scene, 0, &light);
    gi_check_ratio(&report, trace_mean(&params, DIRECT), expected * (1.0 - pow(2.0 / 3.0, 4.0)),
                   1e-4, "point light of limited range");

    light.type = SCENE_LIGHT_SPOT;
    light.range_m = 0.0f;
    light.inner_cone_rad = 0.3f;
    light.outer_cone_rad = 0.7f;
    scene_set_light(scene, 0, &light);
    scene_set_light_placement(scene, 0, (float[3]){0, 0, 2},
                              (float[3]){sinf(0.5f), 0, -cosf(0.5f)});
    double angular = (cos(0.5) - cos(0.7)) / (cos(0.3) - cos(0.7));
    gi_check_ratio(&report, trace_mean(&params, DIRECT), expected * angular * angular, 1e-3,
                   "spot at 0.5 rad");

    light.type = SCENE_LIGHT_DIRECTIONAL;
    light.intensity = 5000.0f;
    scene_set_light(scene, 0, &light);
    scene_set_light_placement(scene, 0, (float[3]){0, 0, 2}, (float[3]){sqrtf(0.75f), 0, -0.5f});
    gi_check_ratio(&report, trace_mean(&params, DIRECT), 0.6 / M_PI * 5000.0 * 0.5, 1e-4,
                   "sun at 60 degrees");
    scene_destroy(&scene);
    gi_report_finish(&report);
}

// The fraction of a hemisphere, weighted by cosine, that a polygon covers: Lambert's sum over
// edges. The whole polygon lies above the receiver's horizon.
static double form_factor(const double point[3], const double normal[3], const double corners[][3],
                          int count)
{
    double sum = 0.0;
    for (int i = 0; i < count; i++) {
        double a[3], b[3], cross[3], length_a = 0.0, length_b = 0.0, dot = 0.0, sine = 0.0;
        for (int axis = 0; axis < 3; axis++) {
            a[axis] = corners[i][axis] - point[axis];
            b[axis] = corners[(i + 1) % count][axis] - point[axis];
            length_a += a[axis] * a[axis];
            length_b += b[axis] * b[axis];
            dot += a[axis] * b[axis];
        }
        for (int axis = 0; axis < 3; axis++) {
            int u = (axis + 1) % 3, v = (axis + 2) % 3;
            cross[axis] = a[u] * b[v] - a[v] * b[u];
            sine += cross[axis] * cross[axis];
        }
        sine = sqrt(sine);
        double angle = acos(dot / sqrt(length_a * length_b));
        for (int axis = 0; axis < 3; axis++)
            sum += angle * cross[axis] / sine * normal[axis] / (2.0 * M_PI);
    }
    return fabs(sum);
}

// One square above another: in the first case it emits, in the second it reflects a light.
static void test_one_reflection_follows_the_form_factor(void **state)
{
    (void)state;
    struct gi_report report = {0};
    const double above[4][3] = {
        {-0.5, -0.5, 1.0}, {-0.5, 0.5, 1.0}, {0.5, 0.5, 1.0}, {0.5, -0.5, 1.0}};
    float corners[4][3];
    for (int i = 0; i < 12; i++)
        corners[i / 3][i % 3] = (float)above[i / 3][i % 3];
    double fraction = form_factor((const double[3]){0, 0, 0}, (const double[3]){0, 0, 1}, above, 4);
    for (int emits = 0; emits < 2; emits++) {
        // The lower square is nearly a point: nothing is reflected back and forth.
        struct scene *scene = test_square_scene(0.01f, 0.5f);
        uint32_t sheet = builtin_add_matte(scene, "sheet", (const float[3]){0.8f, 0.8f, 0.8f});
        scene->materials[sheet].emissive[0] = emits ? 1.0f : 0.0f;
        scene->materials[sheet].emissive_strength = 10.0f;
        uint32_t mesh = scene_add_mesh(scene, "sheet");
        assert_true(builtin_add_quad(scene, corners, sheet));
        assert_int_not_equal(builtin_add_mesh_node(scene, "sheet", mesh), SCENE_NONE);
        scene_update_world_transforms(scene);
        if (!emits) {
            struct scene_light sun;
            scene_light_init(&sun, SCENE_LIGHT_DIRECTIONAL, "sun");
            sun.intensity = 100.0f;
            sun.casts_shadow = false;
            scene_add_light(scene, &sun, (float[3]){0}, (float[3]){0, 0, 1});
        }
        // The camera sees through the sheet's back; from below it would see nothing at all.
        struct path_params params = path_params(scene, 2000);
        params.camera.fov_y_rad = 0.001f;
        double radiance = emits ? 10.0 : 0.8 / M_PI * 100.0;
        gi_check_ratio(&report, trace_mean(&params, emits ? DIRECT : INDIRECT),
                       0.5 * radiance * fraction, 0.005, emits ? "emitter" : "lit sheet");
        scene_destroy(&scene);
    }
    gi_report_finish(&report);
}

static void test_furnace_is_a_geometric_series(void **state)
{
    (void)state;
    static const uint32_t bounces[] = {0, 1, 2, 3, PATH_BOUNCES_UNLIMITED};
    struct gi_report report = {0};
    for (int i = 0; i < 6; i++) {
        double albedo = i % 3 == 0 ? 0.2 : i % 3 == 1 ? 0.5 : 0.8;
        struct scene *scene = gi_box_scene(&(struct gi_box_params){.albedo = (float)albedo,
                                                                   .emission = 3.0f,
                                                                   .half_edge_m = 1.3f,
                                                                   .turn_rad = i < 3 ? 0.0f : 0.4f,
                                                                   .divisions = i < 3 ? 1 : 5});
        struct path_params params = path_params(scene, 256);
        gi_scene_camera(scene, &params.camera);
        for (size_t j = 0; j < sizeof(bounces) / sizeof(bounces[0]); j++) {
            params.bounces = bounces[j];
            bool unlimited = bounces[j] == PATH_BOUNCES_UNLIMITED;
            double series = 1.0 / (1.0 - albedo);
            if (!unlimited)
                series *= 1.0 - pow(albedo, bounces[j] + 2.0);
            gi_check_ratio(&report, trace_mean(&params, TOTAL), 3.0 * series, 0.01,
                           "furnace, albedo %g, bounces %d", albedo,
                           unlimited ? -1 : (int)bounces[j]);
        }
        scene_destroy(&scene);
    }
    gi_report_finish(&report);
}

// The flux of a light in a closed box is absorbed by its walls: irradiance x area x (1 - albedo).
static void test_light_in_a_box_balances(void **state)
{
    (void)state;
    struct gi_report report = {0};
    for (int turned = 0; turned < 2; turned++) {
        struct gi_box_params box = {.albedo = 0.7f,
                                    .intensity_cd = 12.0f,
                                    .half_edge_m = 0.9f,
                                    .turn_rad = turned ? 0.7f : 0.0f,
                                    .divisions = 1};
        struct scene *scene = gi_box_scene(&box);
        double area = 24.0 * 0.9 * 0.9, sum = 0.0;
        for (uint32_t wall = 0; wall < 6; wall++) {
            struct path_params params = path_params(scene, 32);
            gi_box_look_at_wall(box.turn_rad, wall, &params.camera);
            sum += trace_mean(&params, TOTAL) / 6.0;
        }
        gi_check_ratio(&report, sum, 0.7 / M_PI * 4.0 * M_PI * 12.0 / area / (1.0 - 0.7), 0.01,
                       "lamp in a box, turned %d", turned);
        scene_destroy(&scene);
    }
    gi_report_finish(&report);
}

// Under an even sky an open floor of albedo a shows a times the sky; a deep well shows less.
static void test_sky_lights_an_open_floor(void **state)
{
    (void)state;
    struct gi_report report = {0};
    struct scene *scene = test_square_scene(1.0f, 0.35f);
    scene->environment = (struct scene_environment){
        .type = SCENE_ENVIRONMENT_CONSTANT, .intensity = 2.0f, .color = {1.5f, 1.5f, 1.5f}};
    struct path_params params = path_params(scene, 256);
    gi_check_ratio(&report, trace_mean(&params, SKY), 0.35 * 3.0, 0.001, "even sky");
    params.camera.target[0] = 3.0f;
    gi_check_ratio(&report, trace_mean(&params, DIRECT), 3.0, 1e-4, "background");
    // A gradient h + (z - h) |y| over a floor that faces +Y: irradiance pi (h + 2 (z - h) / 3).
    params.camera.target[0] = 0.0f;
    scene->environment.type = SCENE_ENVIRONMENT_GRADIENT;
    scene->environment.intensity = 1.0f;
    scene->environment.color[0] = 4.0f;
    scene->environment.horizon_color[0] = 1.0f;
    scene->nodes[0].rotation[0] = -sqrtf(0.5f);
    scene->nodes[0].rotation[3] = sqrtf(0.5f);
    scene_update_world_transforms(scene);
    params.camera = (struct view_camera){
        .eye = {0.0f, 3.0f, 0.0f}, .up = {0.0f, 0.0f, 1.0f}, .fov_y_rad = 0.01f};
    gi_check_ratio(&report, trace_mean(&params, SKY), 0.35 * (1.0 + 2.0 / 3.0 * 3.0), 0.005,
                   "gradient sky");
    scene_destroy(&scene);
    gi_report_finish(&report);
}

// Under a sky of luminance 1 a white metal shows the directional albedo of its lobe: values by
// numerical integration of the formulas of glTF 2.0, appendix B, seen head on.
static void test_metal_under_a_sky_shows_its_albedo(void **state)
{
    (void)state;
    static const double albedos[][2] = {{0.0, 1.0},   {0.2, 0.998}, {0.4, 0.968},
                                        {0.6, 0.825}, {0.8, 0.555}, {1.0, 0.307}};
    struct gi_report report = {0};
    for (size_t i = 0; i < sizeof(albedos) / sizeof(albedos[0]); i++) {
        struct scene *scene = test_square_scene(1.0f, 1.0f);
        scene->materials[0].metallic = 1.0f;
        scene->materials[0].roughness = (float)albedos[i][0];
        scene->environment = (struct scene_environment){
            .type = SCENE_ENVIRONMENT_CONSTANT, .intensity = 1.0f, .color = {1.0f, 1.0f, 1.0f}};
        struct path_params params = path_params(scene, 64);
        gi_check_ratio(&report, trace_mean(&params, SKY), albedos[i][1], 0.005,
                       "white metal of roughness %g under a sky", albedos[i][0]);
        scene_destroy(&scene);
    }
    gi_report_finish(&report);
}

// Glowing walls light a specular surface as a sky of equal radiance does: by sampling emitters and
// following reflections, and by following reflections alone.
static void test_specular_in_a_glowing_box(void **state)
{
    (void)state;
    struct gi_report report = {0};
    static const float roughnesses[] = {0.05f, 0.3f, 0.9f};
    for (int i = 0; i < 6; i++) {
        double means[2];
        for (int sky = 0; sky < 2; sky++) {
            // Black glowing walls, or nothing but a glowing sky of equal radiance.
            struct scene *scene = sky ? scene_create("sky")
                                      : gi_box_scene(&(struct gi_box_params){
                                            .emission = 1.0f, .half_edge_m = 2.0f, .divisions = 1});
            scene->environment = (struct scene_environment){
                .type = SCENE_ENVIRONMENT_CONSTANT, .intensity = 1.0f, .color = {1.0f, 1.0f, 1.0f}};
            struct scene_material specular;
            scene_material_init(&specular, "gloss");
            specular.base_color[0] = 0.6f;
            specular.metallic = i < 3 ? 0.0f : 1.0f;
            specular.roughness = roughnesses[i % 3];
            uint32_t material = scene_add_material(scene, &specular);
            uint32_t mesh = scene_add_mesh(scene, "gloss");
            const float corners[4][3] = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
            assert_true(builtin_add_quad(scene, corners, material));
            builtin_add_mesh_node(scene, "gloss", mesh);
            scene_update_world_transforms(scene);
            struct path_params params = path_params(scene, 256);
            params.camera.eye[0] = 1.1f;
            params.camera.eye[2] = 0.9f;
            means[sky] = trace_mean(&params, sky ? SKY : DIRECT);
            scene_destroy(&scene);
        }
        gi_check_ratio(&report, means[0], means[1], 0.01, "gloss, roughness %g, metallic %d",
                       (double)roughnesses[i % 3], i / 3);
    }
    gi_report_finish(&report);
}

// GGX of glTF 2.0, appendix B, for a white metal whose normal is +Z: BRDF times the cosine.
static double metal_fraction(const double view[3], const double light[3], double alpha)
{
    double half[3], length = 0.0, a2 = alpha * alpha;
    for (int i = 0; i < 3; i++) {
        half[i] = view[i] + light[i];
        length += half[i] * half[i];
    }
    double n_h = half[2] / sqrt(length), n_l = light[2], n_v = view[2];
    double distribution = a2 / (M_PI * pow(n_h * n_h * (a2 - 1.0) + 1.0, 2.0));
    double visibility =
        0.5 / (n_l * sqrt(n_v * n_v * (1.0 - a2) + a2) + n_v * sqrt(n_l * n_l * (1.0 - a2) + a2));
    return distribution * visibility * n_l;
}

#define LIGHT_HEIGHT_M    2.0
#define LIGHT_HALF_EDGE_M 0.3
#define LIGHT_RADIANCE    8.0

// What the origin shows of a square light above a white metal floor: the sum over the light's area.
static double metal_under_light(const float eye[3], double light_x, double roughness)
{
    const int steps = 400;
    double view[3], length = 0.0, sum = 0.0, step = 2.0 * LIGHT_HALF_EDGE_M / steps;
    for (int i = 0; i < 3; i++)
        length += (double)eye[i] * eye[i];
    for (int i = 0; i < 3; i++)
        view[i] = eye[i] / sqrt(length);
    for (int i = 0; i < steps * steps; i++) {
        double point[3] = {light_x - LIGHT_HALF_EDGE_M + (i % steps + 0.5) * step,
                           -LIGHT_HALF_EDGE_M + (i / steps + 0.5) * step, LIGHT_HEIGHT_M};
        double squared = point[0] * point[0] + point[1] * point[1] + point[2] * point[2];
        double distance = sqrt(squared), light[3];
        for (int axis = 0; axis < 3; axis++)
            light[axis] = point[axis] / distance;
        sum +=
            metal_fraction(view, light, roughness * roughness) * light[2] / squared * step * step;
    }
    return LIGHT_RADIANCE * sum;
}

static struct scene *metal_under_light_scene(double light_x, double roughness)
{
    struct scene *scene = test_square_scene(0.05f, 1.0f);
    scene->materials[0].metallic = 1.0f;
    scene->materials[0].roughness = (float)roughness;
    uint32_t key_light = builtin_add_matte(scene, "lamp", (const float[3]){0.0f, 0.0f, 0.0f});
    scene->materials[key_light].emissive[0] = 1.0f;
    scene->materials[key_light].emissive_strength = (float)LIGHT_RADIANCE;
    uint32_t mesh = scene_add_mesh(scene, "lamp");
    float left = (float)(light_x - LIGHT_HALF_EDGE_M), right = (float)(light_x + LIGHT_HALF_EDGE_M);
    const float edge = (float)LIGHT_HALF_EDGE_M, height = (float)LIGHT_HEIGHT_M;
    const float corners[4][3] = {
        {left, -edge, height}, {left, edge, height}, {right, edge, height}, {right, -edge, height}};
    assert_true(builtin_add_quad(scene, corners, key_light));
    builtin_add_mesh_node(scene, "lamp", mesh);
    scene_update_world_transforms(scene);
    return scene;
}

// The renderer takes a light's specular part from one representative point: its figure is printed,
// not judged.
static void test_specular_of_a_light_is_its_integral(void **state)
{
    (void)state;
    struct gi_report report = {0};
    static const double roughnesses[] = {0.2, 0.4, 0.7};
    static const double offsets_m[] = {0.0, 0.8}; // of the light from its mirror image
    for (int i = 0; i < 6; i++) {
        double roughness = roughnesses[i % 3];
        const float eye[3] = {1.2f, 0.0f, 1.5f};
        double light_x = -1.2 / 1.5 * LIGHT_HEIGHT_M + offsets_m[i / 3];
        struct scene *scene = metal_under_light_scene(light_x, roughness);
        struct path_params params = path_params(scene, 128);
        for (int axis = 0; axis < 3; axis++)
            params.camera.eye[axis] = eye[axis];
        params.camera.fov_y_rad = 0.001f;
        double expected = metal_under_light(eye, light_x, roughness);
        gi_check_ratio(&report, trace_mean(&params, DIRECT), expected, 0.01,
                       "metal of roughness %g, lamp %g m beside the mirror ray", roughness,
                       offsets_m[i / 3]);
        struct frame_params frame = gi_params(33, 33, GI_METHOD_NONE);
        frame.camera = params.camera;
        struct test_picture shown = gi_draw(scene, &frame);
        print_message("      the renderer shows %.4f of that\n",
                      (double)test_center(&shown) / expected);
        gi_picture_finish(&shown);
        scene_destroy(&scene);
    }
    gi_report_finish(&report);
}

static struct scene *load_builtin_without_sky(const char *name)
{
    struct error error = {""};
    struct scene *scene = scene_create_builtin(name, &error);
    assert_non_null(scene);
    scene->environment.type = SCENE_ENVIRONMENT_NONE;
    return scene;
}

// Means over the image: the renderer casts an emitter's shadow from its centre, which moves light,
// but on the whole neither adds nor loses much. Both use the same camera rays: a light is much
// brighter than what it lights, and few pixels wide.
static void check_direct_light(struct gi_report *report, struct scene *scene, double tolerance)
{
    struct frame_params frame = gi_params(96, 96, GI_METHOD_NONE);
    frame.quality = QUALITY_FINAL;
    gi_scene_camera(scene, &frame.camera);
    struct test_picture shown = gi_draw(scene, &frame);
    struct path_params params = path_params(scene, 16);
    params.camera = frame.camera;
    params.width = params.height = 2 * 96; // final quality averages four pixels
    params.bounces = 0;
    params.pixel_center = true;
    struct path_picture traced;
    assert_true(path_trace(&params, &traced));
    double measured[3], expected[3];
    gi_mean(shown.pixels, 96, 96, measured);
    gi_mean(traced.direct, traced.width, traced.height, expected);
    for (int c = 0; c < 3; c++)
        gi_check_ratio(report, measured[c], expected[c], tolerance, "%s, direct light, channel %d",
                       scene->name, c);
    path_picture_finish(&traced);
    gi_picture_finish(&shown);
    scene_destroy(&scene);
}

static void test_renderer_shows_the_same_direct_light(void **state)
{
    (void)state;
    struct gi_report report = {0};
    check_direct_light(&report, load_builtin_without_sky("cornell"), 0.02);
    check_direct_light(&report, gi_corridor_scene(), 0.02);
    check_direct_light(&report, load_builtin_without_sky("material-grid"), 0.02);
    gi_report_finish(&report);
}

static void test_seed_alone_decides(void **state)
{
    (void)state;
    struct scene *scene = gi_corridor_scene();
    struct path_params params = path_params(scene, 4);
    gi_scene_camera(scene, &params.camera);
    params.threads = 1;
    double once = trace_mean(&params, TOTAL);
    params.threads = 3;
    assert_true(trace_mean(&params, TOTAL) == once);
    params.seed = 8;
    assert_true(trace_mean(&params, TOTAL) != once);
    scene_destroy(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_punctual_lights_follow_their_formulas),
        cmocka_unit_test(test_one_reflection_follows_the_form_factor),
        cmocka_unit_test(test_furnace_is_a_geometric_series),
        cmocka_unit_test(test_light_in_a_box_balances),
        cmocka_unit_test(test_sky_lights_an_open_floor),
        cmocka_unit_test(test_metal_under_a_sky_shows_its_albedo),
        cmocka_unit_test(test_specular_in_a_glowing_box),
        cmocka_unit_test(test_specular_of_a_light_is_its_integral),
        cmocka_unit_test(test_renderer_shows_the_same_direct_light),
        cmocka_unit_test(test_seed_alone_decides),
    };
    return cmocka_run_group_tests(tests, NULL, test_renderer_teardown);
}
