// Proves how frames run: nothing runs when nothing changed, an edit reruns only what depends on it,
// only the effects that a scene needs are on, leaving the others out changes no pixel, transparent
// layers blend in order of depth, outputs agree with one another, and a broken shader keeps the
// last good one.
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "support_gpu.h"

static void draw_and_drop(struct renderer *renderer, struct view *view,
                          const struct frame_params *params)
{
    struct error error = {""};
    struct frame_pixels pixels;
    enum render_result result = renderer_view_draw(renderer, view, params, &error);
    if (result != RENDER_DRAWN)
        fail_msg("result %d: %s", result, error.message);
    assert_true(renderer_view_collect(renderer, view, true, &pixels));
    renderer_view_release(renderer, view);
}

static bool pass_ran(const struct renderer *renderer, const struct view *view, const char *name)
{
    struct frame_statistics statistics;
    renderer_view_get_statistics(renderer, view, &statistics);
    for (uint32_t i = 0; i < statistics.pass_count; i++)
        if (strcmp(statistics.passes[i].name, name) == 0) {
            assert_true(statistics.passes[i].ran || statistics.passes[i].reason[0] != '\0');
            return statistics.passes[i].ran;
        }
    fail_msg("there is no pass %s", name);
    return false;
}

static bool effect_is_on(const struct renderer *renderer, const struct view *view, const char *name)
{
    struct frame_statistics statistics;
    renderer_view_get_statistics(renderer, view, &statistics);
    for (uint32_t i = 0; i < statistics.effect_count; i++)
        if (strcmp(statistics.effects[i].name, name) == 0) {
            assert_true(statistics.effects[i].reason[0] != '\0');
            return statistics.effects[i].on;
        }
    fail_msg("there is no effect %s", name);
    return false;
}

static void test_only_what_changed_runs(void **state)
{
    (void)state;
    struct renderer *renderer = test_renderer();
    struct error error = {""};
    struct scene *scene = scene_create_builtin("cornell", &error);
    assert_non_null(scene);
    assert_true(renderer_set_scene(renderer, scene, &error));
    struct view *view = renderer_view_create(renderer);
    struct frame_params params = test_params(64, 64, FRAME_OUTPUT_YCBCR);
    scene_get_camera_placement(scene, 0, params.camera.eye, params.camera.target, params.camera.up);
    draw_and_drop(renderer, view, &params);
    assert_true(pass_ran(renderer, view, "visibility"));
    assert_true(pass_ran(renderer, view, "shadow_map"));
    assert_int_equal(renderer_view_draw(renderer, view, &params, &error), RENDER_UNCHANGED);

    params.camera.eye[0] += 0.01f;
    draw_and_drop(renderer, view, &params);
    assert_true(pass_ran(renderer, view, "visibility"));
    assert_false(pass_ran(renderer, view, "shadow_map"));

    params.settings.exposure_ev = 1.0f;
    draw_and_drop(renderer, view, &params);
    assert_false(pass_ran(renderer, view, "visibility"));
    assert_false(pass_ran(renderer, view, "gbuffer"));

    struct scene_light light;
    scene_light_init(&light, SCENE_LIGHT_POINT, "lamp");
    uint32_t id = scene_add_light(scene, &light, (float[3]){0, 0.3f, 0}, (float[3]){0, -1, 0});
    draw_and_drop(renderer, view, &params);
    assert_true(pass_ran(renderer, view, "shadow_map"));

    light = scene->lights[id];
    light.intensity = 2.0f;
    scene_set_light(scene, id, &light);
    draw_and_drop(renderer, view, &params);
    assert_false(pass_ran(renderer, view, "visibility"));
    assert_false(pass_ran(renderer, view, "shadow_map"));
    assert_true(pass_ran(renderer, view, "direct_light"));

    // Another colour casts no other shadow; hiding an object does.
    struct scene_material material = scene->materials[0];
    material.base_color[0] = 0.2f;
    scene_set_material(scene, 0, &material);
    draw_and_drop(renderer, view, &params);
    assert_true(pass_ran(renderer, view, "gbuffer"));
    assert_false(pass_ran(renderer, view, "shadow_map"));

    scene_set_node_visible(scene, 5, false);
    draw_and_drop(renderer, view, &params);
    assert_true(pass_ran(renderer, view, "visibility"));
    assert_true(pass_ran(renderer, view, "shadow_map"));
    assert_int_equal(renderer_view_draw(renderer, view, &params, &error), RENDER_UNCHANGED);
    renderer_view_destroy(renderer, &view);
    renderer_set_scene(renderer, NULL, &error);
    scene_destroy(&scene);
}

static void test_effects_follow_the_scene(void **state)
{
    (void)state;
    struct renderer *renderer = test_renderer();
    struct error error = {""};
    struct scene *scene = test_square_scene(1.0f, 0.5f);
    assert_true(renderer_set_scene(renderer, scene, &error));
    struct view *view = renderer_view_create(renderer);
    struct frame_params params = test_params(32, 32, FRAME_OUTPUT_YCBCR);
    test_look_down_z(&params, 3.0f);
    draw_and_drop(renderer, view, &params);
    static const char *const names[] = {
        "textures",     "alpha_mask",   "punctual_lights", "specular",     "vertex_colors",
        "flat_shadows", "cube_shadows", "area_lights",     "shadows",      "light_tiles",
        "blinn_phong",  "environment",  "transparency",    "auto_exposure"};
    for (size_t i = 0; i < sizeof(names) / sizeof(names[0]); i++)
        assert_false(effect_is_on(renderer, view, names[i]));
    assert_true(pass_ran(renderer, view, "emission"));
    assert_false(pass_ran(renderer, view, "direct_light"));

    struct scene_light light;
    scene_light_init(&light, SCENE_LIGHT_POINT, "lamp");
    uint32_t id = scene_add_light(scene, &light, (float[3]){0, 0, 2}, (float[3]){0, 0, -1});
    draw_and_drop(renderer, view, &params);
    assert_true(effect_is_on(renderer, view, "punctual_lights"));
    assert_true(effect_is_on(renderer, view, "shadows"));
    assert_false(effect_is_on(renderer, view, "light_tiles"));
    assert_false(pass_ran(renderer, view, "emission"));
    scene_remove_light(scene, id);
    draw_and_drop(renderer, view, &params);
    assert_false(effect_is_on(renderer, view, "punctual_lights"));
    assert_false(effect_is_on(renderer, view, "shadows"));

    struct scene_environment environment = {
        .type = SCENE_ENVIRONMENT_CONSTANT, .intensity = 1.0f, .color = {1, 1, 1}};
    scene_set_environment(scene, &environment);
    draw_and_drop(renderer, view, &params);
    assert_true(effect_is_on(renderer, view, "environment"));
    environment.type = SCENE_ENVIRONMENT_NONE;
    scene_set_environment(scene, &environment);

    struct scene_material material = scene->materials[0];
    material.transmission = 1.0f;
    scene_set_material(scene, 0, &material);
    draw_and_drop(renderer, view, &params);
    assert_true(effect_is_on(renderer, view, "transparency"));
    assert_true(pass_ran(renderer, view, "transparency"));
    renderer_view_destroy(renderer, &view);
    renderer_set_scene(renderer, NULL, &error);
    scene_destroy(&scene);
}

// Without the code that is left out, a compiler may round sums differently: 0.01 % is far below one
// step of a displayed pixel.
static void test_left_out_effects_change_no_pixel(void **state)
{
    (void)state;
    for (uint32_t i = 0; scene_builtin_name(i); i++) {
        struct error error = {""};
        struct scene *scene = scene_create_builtin(scene_builtin_name(i), &error);
        assert_non_null(scene);
        struct frame_params params = test_params(96, 54, FRAME_OUTPUT_LINEAR);
        scene_get_camera_placement(scene, 0, params.camera.eye, params.camera.target,
                                   params.camera.up);
        struct test_picture planned = test_draw_linear(scene, &params);
        params.settings.force_all_effects = true;
        struct test_picture forced = test_draw_linear(scene, &params);
        for (size_t j = 0; j < (size_t)planned.width * planned.height * 4; j++)
            if (fabsf(planned.pixels[j] - forced.pixels[j]) >
                1e-5f + 1e-4f * fabsf(forced.pixels[j]))
                fail_msg("%s: value %zu is %g planned and %g forced", scene_builtin_name(i), j,
                         (double)planned.pixels[j], (double)forced.pixels[j]);
        free(planned.pixels);
        free(forced.pixels);
        renderer_set_scene(test_renderer(), NULL, &error);
        scene_destroy(&scene);
    }
}

// Three half-covering emissive sheets in front of a bright wall: c = sum over the layers, back to
// front.
static void test_layers_blend_in_order_of_depth(void **state)
{
    (void)state;
    struct scene *scene = test_square_scene(1.0f, 0.0f);
    struct scene_material wall = scene->materials[0];
    wall.emissive[0] = 1.0f;
    wall.emissive_strength = 8.0f;
    scene_set_material(scene, 0, &wall);
    static const float strengths[3] = {1.0f, 2.0f, 4.0f}, heights[3] = {0.2f, 0.6f, 0.4f};
    const uint32_t indices[6] = {0, 1, 2, 0, 2, 3};
    for (int i = 0; i < 3; i++) {
        struct scene_material sheet = wall;
        sheet.emissive_strength = strengths[i];
        sheet.alpha_mode = SCENE_ALPHA_BLEND;
        sheet.base_color[3] = 0.5f;
        uint32_t material = scene_add_material(scene, &sheet);
        struct scene_vertex vertices[4];
        memcpy(vertices, scene->vertices, sizeof(vertices));
        uint32_t mesh = scene_add_mesh(scene, "sheet");
        assert_int_not_equal(scene_add_primitive(scene, vertices, 4, indices, 6, material),
                             SCENE_NONE);
        uint32_t node = scene_add_node(scene, "sheet", SCENE_NONE);
        scene->nodes[node].mesh = mesh;
        scene->nodes[node].translation[2] = heights[i];
    }
    scene_update_world_transforms(scene);
    struct frame_params params = test_params(33, 33, FRAME_OUTPUT_LINEAR);
    test_look_down_z(&params, 3.0f);
    struct test_picture picture = test_draw_linear(scene, &params);
    // From the wall: 0.2 m (1), 0.4 m (4), 0.6 m (2).
    double expected = 8.0;
    expected = expected * 0.5 + 1.0 * 0.5;
    expected = expected * 0.5 + 4.0 * 0.5;
    expected = expected * 0.5 + 2.0 * 0.5;
    assert_true(fabs(test_center(&picture) - expected) < 0.005 * expected);
    free(picture.pixels);
    struct error error;
    renderer_set_scene(test_renderer(), NULL, &error);
    scene_destroy(&scene);
}

// Luma of the planar output equals that of the RGBA output, for sizes that pad rows.
static void test_outputs_agree(void **state)
{
    (void)state;
    struct renderer *renderer = test_renderer();
    struct error error = {""};
    struct scene *scene = scene_create_builtin("cornell", &error);
    assert_true(renderer_set_scene(renderer, scene, &error));
    static const uint32_t sizes[][2] = {{64, 48}, {37, 21}, {1, 1}, {200, 3}};
    for (size_t i = 0; i < sizeof(sizes) / sizeof(sizes[0]); i++) {
        uint32_t width = sizes[i][0], height = sizes[i][1];
        struct frame_params params = test_params(width, height, FRAME_OUTPUT_RGBA8);
        scene_get_camera_placement(scene, 0, params.camera.eye, params.camera.target,
                                   params.camera.up);
        struct view *views[2] = {renderer_view_create(renderer), renderer_view_create(renderer)};
        struct frame_pixels rgba, planar;
        assert_int_equal(renderer_view_draw(renderer, views[0], &params, &error), RENDER_DRAWN);
        params.output = FRAME_OUTPUT_YCBCR;
        assert_int_equal(renderer_view_draw(renderer, views[1], &params, &error), RENDER_DRAWN);
        assert_true(renderer_view_collect(renderer, views[0], true, &rgba));
        assert_true(renderer_view_collect(renderer, views[1], true, &planar));
        for (uint32_t y = 0; y < height; y++)
            for (uint32_t x = 0; x < width; x++) {
                const uint8_t *p = rgba.planes[0] + y * rgba.row_pitch_bytes[0] + 4 * x;
                double luma = 0.299 * p[0] + 0.587 * p[1] + 0.114 * p[2];
                double measured = planar.planes[0][y * planar.row_pitch_bytes[0] + x];
                assert_true(fabs(luma - measured) <= 1.01);
            }
        renderer_view_release(renderer, views[0]);
        renderer_view_release(renderer, views[1]);
        renderer_view_destroy(renderer, &views[0]);
        renderer_view_destroy(renderer, &views[1]);
    }
    renderer_set_scene(renderer, NULL, &error);
    scene_destroy(&scene);
}

// A wall that emits L everywhere: automatic exposure brings L to the same middle value for any L.
static void test_exposure_is_found_and_told(void **state)
{
    (void)state;
    struct renderer *renderer = test_renderer();
    struct error error = {""};
    float products[2];
    for (int i = 0; i < 2; i++) {
        struct scene *scene = test_square_scene(5.0f, 0.0f);
        struct scene_material material = scene->materials[0];
        float radiance = i ? 400.0f : 0.02f;
        material.emissive[0] = material.emissive[1] = material.emissive[2] = 1.0f;
        material.emissive_strength = radiance;
        scene_set_material(scene, 0, &material);
        assert_true(renderer_set_scene(renderer, scene, &error));
        struct view *view = renderer_view_create(renderer);
        struct frame_params params = test_params(64, 64, FRAME_OUTPUT_YCBCR);
        params.settings.exposure_mode = EXPOSURE_AUTOMATIC;
        test_look_down_z(&params, 3.0f);
        draw_and_drop(renderer, view, &params);
        struct frame_statistics statistics;
        renderer_view_get_statistics(renderer, view, &statistics);
        products[i] = statistics.exposure * radiance;
        params.settings.exposure_mode = EXPOSURE_FIXED;
        params.settings.exposure_ev = 3.0f;
        draw_and_drop(renderer, view, &params);
        renderer_view_get_statistics(renderer, view, &statistics);
        assert_true(statistics.exposure == 8.0f);
        renderer_view_destroy(renderer, &view);
        renderer_set_scene(renderer, NULL, &error);
        scene_destroy(&scene);
    }
    assert_true(products[0] > 0.1f && products[0] < 1.0f);
    assert_true(fabsf(products[0] / products[1] - 1.0f) < 0.2f); // a bin of the histogram
}

static void test_bad_parameters_are_refused(void **state)
{
    (void)state;
    struct renderer *renderer = test_renderer();
    struct error error = {""};
    struct scene *scene = test_square_scene(1.0f, 0.5f);
    assert_true(renderer_set_scene(renderer, scene, &error));
    struct view *view = renderer_view_create(renderer);
    struct frame_params params = test_params(0, 32, FRAME_OUTPUT_YCBCR);
    assert_int_equal(renderer_view_draw(renderer, view, &params, &error), RENDER_FAILED);
    assert_non_null(strstr(error.message, "0x32"));
    assert_non_null(strstr(error.message, "4096x2160"));
    params = test_params(32, 32, FRAME_OUTPUT_YCBCR);
    params.camera.eye[1] = NAN;
    assert_int_equal(renderer_view_draw(renderer, view, &params, &error), RENDER_FAILED);
    // Four uncollected frames are one too many.
    params.camera.eye[1] = 0.0f;
    for (uint32_t i = 0; i < RENDERER_FRAMES_IN_RING; i++) {
        params.camera.eye[0] = (float)i;
        assert_int_equal(renderer_view_draw(renderer, view, &params, &error), RENDER_DRAWN);
    }
    params.camera.eye[0] = 9.0f;
    assert_int_equal(renderer_view_draw(renderer, view, &params, &error), RENDER_BUSY);
    renderer_view_destroy(renderer, &view);
    renderer_set_scene(renderer, NULL, &error);
    scene_destroy(&scene);
}

static void test_picking_names_what_is_seen(void **state)
{
    (void)state;
    struct renderer *renderer = test_renderer();
    struct error error = {""};
    struct scene *scene = scene_create_builtin("cornell", &error);
    assert_true(renderer_set_scene(renderer, scene, &error));
    struct view_camera camera = {.up = {0, 1, 0}, .fov_y_rad = 0.686f};
    scene_get_camera_placement(scene, 0, camera.eye, camera.target, camera.up);
    struct ray_hit hit;
    assert_true(renderer_pick(renderer, &camera, 100, 100, 65, 75, &hit));
    assert_string_equal(scene->nodes[hit.node].name, "short block");
    assert_true(hit.normal[2] > 0.5f);
    assert_true(renderer_pick(renderer, &camera, 100, 100, 4, 50, &hit));
    assert_non_null(strstr(scene->nodes[hit.node].name, "red"));
    renderer_set_scene(renderer, NULL, &error);
    scene_destroy(&scene);
}

static int run(const char *format, const char *a, const char *b)
{
    char command[2048];
    snprintf(command, sizeof(command), format, a, b);
    return system(command);
}

static void test_broken_shader_keeps_the_last_good_one(void **state)
{
    (void)state;
    char folder[] = "/tmp/voxcast-shaders-XXXXXX";
    assert_non_null(mkdtemp(folder));
    assert_int_equal(run("cp -r '%s'/. '%s'", test_shader_dir(), folder), 0);
    struct error error = {""};
    struct renderer *renderer = renderer_create(
        &(struct renderer_params){.shader_dir = folder, .watch_shaders = true}, &error);
    assert_non_null(renderer);
    struct scene *scene = test_square_scene(1.0f, 0.5f);
    assert_true(renderer_set_scene(renderer, scene, &error));
    struct view *view = renderer_view_create(renderer);
    struct frame_params params = test_params(16, 16, FRAME_OUTPUT_YCBCR);
    test_look_down_z(&params, 3.0f);
    draw_and_drop(renderer, view, &params);
    assert_int_equal(renderer_poll_shaders(renderer, &error), 0);

    assert_int_equal(run("echo 'this is no GLSL' >>'%s/%s'", folder, "light/emission.comp"), 0);
    error.message[0] = '\0';
    assert_int_equal(renderer_poll_shaders(renderer, &error), 0);
    assert_non_null(strstr(error.message, "light/emission.comp:"));
    params.camera.eye[0] = 0.1f;
    draw_and_drop(renderer, view, &params);

    assert_int_equal(
        run("cp '%s/light/emission.comp' '%s/light/emission.comp'", test_shader_dir(), folder), 0);
    assert_int_equal(renderer_poll_shaders(renderer, &error), 1);
    params.camera.eye[0] = 0.2f;
    draw_and_drop(renderer, view, &params);
    renderer_view_destroy(renderer, &view);
    renderer_destroy(&renderer);
    scene_destroy(&scene);
    assert_int_equal(run("rm -r '%s'%s", folder, ""), 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_only_what_changed_runs),
        cmocka_unit_test(test_effects_follow_the_scene),
        cmocka_unit_test(test_left_out_effects_change_no_pixel),
        cmocka_unit_test(test_layers_blend_in_order_of_depth),
        cmocka_unit_test(test_outputs_agree),
        cmocka_unit_test(test_exposure_is_found_and_told),
        cmocka_unit_test(test_bad_parameters_are_refused),
        cmocka_unit_test(test_picking_names_what_is_seen),
        // Last: it makes a second context current.
        cmocka_unit_test(test_broken_shader_keeps_the_last_good_one),
    };
    return cmocka_run_group_tests(tests, NULL, test_renderer_teardown);
}
