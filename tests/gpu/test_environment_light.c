// Proves that an equirectangular image lights a scene correctly: one of a constant colour like the
// constant environment, and one with a sun of a single texel like the path tracer. The images are
// written as OpenEXR files and loaded; rendered images are compared as linear radiance.
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "renderer/import/builtin/builtin.h"
#include "renderer/import/builtin/mesh_builder.h"
#include "renderer/import/scene_load.h"
#include "support_gi.h"
#include "tests/support/exr_file.h"

#define WIDTH        512
#define HEIGHT       256
#define PICTURE_EDGE 48

// Gives the scene an image of one colour, except for one texel that is a grey sun.
static void load_sky(struct scene *scene, const float color[3], int sun_texel, float sun)
{
    float *texels = calloc(WIDTH * HEIGHT, 4 * sizeof(float));
    char path[] = "/tmp/voxcast-sky-XXXXXX";
    struct error error = {""};
    size_t size;
    assert_non_null(texels);
    for (int i = 0; i < WIDTH * HEIGHT; i++)
        for (int c = 0; c < 3; c++)
            texels[4 * i + c] = i == sun_texel ? sun : color[c];
    uint8_t *bytes = exr_file_write(
        &(struct exr_file_params){.width = WIDTH, .height = HEIGHT, .channels = "BGR"}, texels,
        &size);
    assert_non_null(bytes);
    int file = mkstemp(path);
    assert_int_equal(write(file, bytes, size), size);
    close(file);
    struct scene_environment environment = scene->environment;
    environment.image = NULL;
    if (!scene_load_environment(path, &environment, &error))
        fail_msg("%s", error.message);
    environment.intensity = 1.0f;
    scene_set_environment(scene, &environment);
    unlink(path);
    free(bytes);
    free(texels);
}

// A ball of radius 1 m, white but for `albedo`.
static struct scene *ball_scene(float albedo, bool metal)
{
    struct scene *scene = scene_create("ball");
    struct scene_material material;
    scene_material_init(&material, "ball");
    for (int c = 0; c < 3; c++)
        material.base_color[c] = albedo;
    material.metallic = metal ? 1.0f : 0.0f;
    material.roughness = metal ? 0.4f : 1.0f;
    material.ior = 1.0f;
    uint32_t id = scene_add_material(scene, &material);
    struct mesh_builder builder;
    mesh_builder_init(&builder);
    mesh_builder_add_sphere(&builder, (float[3]){0, 0, 0}, 1.0f, 64, 32);
    uint32_t mesh = mesh_builder_commit_mesh(&builder, scene, "ball", id);
    assert_true(mesh != SCENE_NONE);
    assert_true(builtin_add_mesh_node(scene, "ball", mesh) != SCENE_NONE);
    scene_update_world_transforms(scene);
    return scene;
}

static struct view_camera look_from(int side)
{
    const float eyes[4][3] = {{4, 0.5f, 0}, {-4, 0.5f, 0}, {0, 0.5f, 4}, {0, 0.5f, -4}};
    struct view_camera camera = {.up = {0, 1, 0}, .fov_y_rad = 0.6f};
    memcpy(camera.eye, eyes[side], sizeof(camera.eye));
    return camera;
}

static const enum gi_method methods[] = {GI_METHOD_NONE, GI_METHOD_CLIPMAP, GI_METHOD_GRID};

static void test_a_constant_image_is_a_constant_sky(void **state)
{
    (void)state;
    struct gi_report report = {0};
    const float color[3] = {0.5f, 1.0f, 2.5f};
    for (size_t m = 0; m < sizeof(methods) / sizeof(methods[0]); m++)
        for (int metal = 0; metal < 2; metal++) {
            struct test_picture pictures[2];
            for (int image = 0; image < 2; image++) {
                struct scene *scene = ball_scene(0.7f, metal);
                if (image)
                    load_sky(scene, color, -1, 0.0f);
                else
                    scene->environment =
                        (struct scene_environment){.type = SCENE_ENVIRONMENT_CONSTANT,
                                                   .intensity = 1.0f,
                                                   .color = {color[0], color[1], color[2]}};
                struct frame_params params = gi_params(PICTURE_EDGE, PICTURE_EDGE, methods[m]);
                params.camera = look_from(0);
                pictures[image] = gi_draw(scene, &params);
                scene_destroy(&scene);
            }
            double worst = 0.0;
            for (int i = 0; i < PICTURE_EDGE * PICTURE_EDGE * 4; i++)
                if (i % 4 < 3)
                    worst = fmax(
                        worst,
                        fabs((double)pictures[1].pixels[i] / (double)pictures[0].pixels[i] - 1.0));
            // 0.0006 measured: half floats of the background, and sums in another order.
            gi_check(&report, worst < 0.002, "%s, metal %d: pixels differ by %.4f at most",
                     gi_method_names[methods[m]], metal, worst);
            for (int image = 0; image < 2; image++)
                gi_picture_finish(&pictures[image]);
        }
    gi_report_finish(&report);
}

// Light that the ball reflects, averaged over the image. What is seen beside it cancels out.
static double reflected(bool metal, int side, int sun_texel, enum gi_method method)
{
    const float sky[3] = {0.3f, 0.3f, 0.3f};
    double means[2];
    for (int white = 0; white < 2; white++) {
        struct scene *scene = ball_scene(white ? 0.7f : 0.0f, metal);
        load_sky(scene, sky, sun_texel, 50000.0f);
        struct frame_params params = gi_params(PICTURE_EDGE, PICTURE_EDGE, method);
        params.camera = look_from(side);
        struct test_picture picture = gi_draw(scene, &params);
        double rgb[3];
        gi_mean(picture.pixels, PICTURE_EDGE, PICTURE_EDGE, rgb);
        means[white] = rgb[0];
        gi_picture_finish(&picture);
        scene_destroy(&scene);
    }
    return means[1] - means[0];
}

static double traced(bool metal, int side, int sun_texel)
{
    const float sky[3] = {0.3f, 0.3f, 0.3f};
    struct scene *scene = ball_scene(0.7f, metal);
    load_sky(scene, sky, sun_texel, 50000.0f);
    struct path_params params = {.scene = scene,
                                 .camera = look_from(side),
                                 .width = PICTURE_EDGE,
                                 .height = PICTURE_EDGE,
                                 .samples = 64,
                                 .estimator = REFERENCE_MIS};
    struct path_picture picture;
    double rgb[3];
    assert_true(path_trace(&params, &picture));
    gi_mean(picture.sky, PICTURE_EDGE, PICTURE_EDGE, rgb);
    path_picture_finish(&picture);
    scene_destroy(&scene);
    return rgb[0];
}

// The sun stands at an elevation of about 30 degrees, then near a pole.
static void test_a_sun_of_one_texel_agrees_with_the_path_tracer(void **state)
{
    (void)state;
    static const int suns[] = {80 * WIDTH + 184, 24 * WIDTH + 320};
    struct gi_report report = {0};
    for (int i = 0; i < 4; i++) {
        bool metal = i >= 2;
        int sun = suns[i % 2];
        double expected = 0.0;
        for (int side = 0; side < 4; side++)
            expected += traced(metal, side, sun) / 4.0;
        for (size_t m = 0; m < 2; m++) { // grids work as clipmaps do here
            double sum = 0.0;
            for (int side = 0; side < 4; side++)
                sum += reflected(metal, side, sun, methods[m]) / 4.0;
            // Measured: matte 0.3 % by harmonics and 3.2 % by cones; metal 8.9 % and 7.0 %, of
            // which blurring about the mirror's direction alone is the cause.
            double tolerance = metal ? 0.12 : methods[m] == GI_METHOD_NONE ? 0.01 : 0.05;
            gi_check_ratio(&report, sum, expected, tolerance, "%s ball, sun %d, %s",
                           metal ? "metal" : "matte", i % 2, gi_method_names[methods[m]]);
        }
    }
    gi_report_finish(&report);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_a_constant_image_is_a_constant_sky),
        cmocka_unit_test(test_a_sun_of_one_texel_agrees_with_the_path_tracer),
    };
    return cmocka_run_group_tests(tests, NULL, test_renderer_teardown);
}
