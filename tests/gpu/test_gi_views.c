// Proves that each debug view makes a finite image with every method of global illumination, that
// the views of voxels show the scene where it is, and that views with nothing to show say so.
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "support_gi.h"
#include "support_gi_scenes.h"

#define WIDTH  96u
#define HEIGHT 54u

static struct scene *load_scene(const char *name)
{
    struct error error = {""};
    struct scene *scene = scene_create_builtin(name, &error);
    if (!scene)
        fail_msg("%s", error.message);
    return scene;
}

static struct frame_params view_params(const struct scene *scene, enum gi_method method,
                                       enum debug_view view)
{
    struct frame_params params = gi_params(WIDTH, HEIGHT, method);
    params.debug_view = view;
    params.settings.bounces = 1; // so that it converges soon
    gi_scene_camera(scene, &params.camera);
    return params;
}

// The fraction of pixels that are not black, and whether all are finite and none negative.
static double lit_fraction(const struct test_picture *picture, bool *out_finite)
{
    uint32_t count = picture->width * picture->height, lit = 0;
    *out_finite = true;
    for (uint32_t i = 0; i < count; i++) {
        const float *rgb = picture->pixels + (size_t)i * 4;
        for (int c = 0; c < 3; c++)
            *out_finite = *out_finite && isfinite(rgb[c]) && rgb[c] >= 0.0f;
        lit += rgb[0] + rgb[1] + rgb[2] > 0.0f;
    }
    return (double)lit / count;
}

static bool is_plain(const struct test_picture *picture, float value)
{
    for (uint32_t i = 0; i < picture->width * picture->height; i++)
        for (size_t c = 0; c < 3; c++)
            if (picture->pixels[(size_t)i * 4 + c] != value)
                return false;
    return true;
}

static void check_view(struct gi_report *report, struct view *drawn,
                       const struct frame_params *params)
{
    enum gi_method method = params->settings.gi_method;
    enum debug_view view = params->debug_view;
    struct test_picture picture = gi_draw_in(drawn, params);
    bool finite;
    double lit = lit_fraction(&picture, &finite);
    const char *method_name = gi_method_names[method];
    const char *name = debug_view_names[view];
    gi_check(report, finite, "%s, %s: every pixel is finite", method_name, name);
    if (method == GI_METHOD_NONE && debug_view_needs_voxels(view))
        gi_check(report, is_plain(&picture, 0.5f), "%s, %s: plain grey", method_name, name);
    else if (view != DEBUG_VIEW_INDIRECT_SPECULAR && view != DEBUG_VIEW_EMISSION &&
             view != DEBUG_VIEW_METALLIC && view != DEBUG_VIEW_LIGHTS_PER_TILE)
        gi_check(report, lit > 0.02, "%s, %s: %.3f of the picture is lit", method_name, name, lit);
    gi_picture_finish(&picture);
}

static void test_every_view_is_finite(void **state)
{
    (void)state;
    struct gi_report report = {0};
    struct scene *scene = load_scene("cornell");
    for (int method = 0; method < GI_METHOD_REFERENCE; method++) {
        struct view *drawn = gi_show(scene);
        for (int view = 0; view < DEBUG_VIEW_COUNT; view++) {
            struct frame_params params =
                view_params(scene, (enum gi_method)method, (enum debug_view)view);
            check_view(&report, drawn, &params);
        }
        gi_hide(&drawn);
    }
    scene_destroy(&scene);
    gi_report_finish(&report);
}

// Levels beyond the last one, and mip levels, which have no cells.
static void test_every_level_is_finite(void **state)
{
    (void)state;
    struct gi_report report = {0};
    struct scene *scene = load_scene("cornell");
    for (uint32_t m = 0; m < GI_PROVED_METHODS; m++) {
        struct view *drawn = gi_show(scene);
        for (uint32_t level = 1; level <= 9; level *= 3)
            for (int view = DEBUG_VIEW_VOXEL_OPACITY; view <= (int)DEBUG_VIEW_VOXEL_IRRADIANCE;
                 view++) {
                struct frame_params params =
                    view_params(scene, gi_proved_methods[m], (enum debug_view)view);
                params.debug_level = level;
                params.settings.voxel_directions = level == 3 ? VOXEL_ISOTROPIC : VOXEL_ANISOTROPIC;
                struct test_picture picture = gi_draw_in(drawn, &params);
                bool finite;
                double lit = lit_fraction(&picture, &finite);
                gi_check(&report, finite && lit > 0.1, "%s, %s, level %u: %.3f is lit",
                         gi_method_names[gi_proved_methods[m]], debug_view_names[view], level, lit);
                gi_picture_finish(&picture);
            }
        gi_hide(&drawn);
    }
    scene_destroy(&scene);
    gi_report_finish(&report);
}

static const float *pixel_at(const struct test_picture *picture, float x, float y)
{
    uint32_t column = (uint32_t)(x * (float)picture->width);
    uint32_t row = (uint32_t)(y * (float)picture->height);
    return picture->pixels + ((size_t)row * picture->width + column) * 4;
}

// Left wall red, right wall green, back wall and floor white; each by the face that looks inwards.
static void test_albedo_shows_the_walls(void **state)
{
    (void)state;
    static const struct {
        const char *what;
        float x, y; // in the image
        enum voxel_face face;
        bool red, green, blue; // much of each
    } walls[] = {
        {"left wall", 0.30f, 0.5f, VOXEL_FACE_POSITIVE_X, true, false, false},
        {"right wall", 0.71f, 0.5f, VOXEL_FACE_NEGATIVE_X, false, true, false},
        {"back wall", 0.50f, 0.3f, VOXEL_FACE_POSITIVE_Z, true, true, true},
        {"floor", 0.35f, 0.93f, VOXEL_FACE_POSITIVE_Y, true, true, true},
    };
    struct gi_report report = {0};
    struct scene *scene = load_scene("cornell");
    struct view *view = gi_show(scene);
    for (size_t i = 0; i < sizeof(walls) / sizeof(walls[0]); i++) {
        struct frame_params params = view_params(scene, GI_METHOD_GRID, DEBUG_VIEW_VOXEL_ALBEDO);
        params.debug_face = walls[i].face;
        struct test_picture picture = gi_draw_in(view, &params);
        const float *rgb = pixel_at(&picture, walls[i].x, walls[i].y);
        bool much[3] = {walls[i].red, walls[i].green, walls[i].blue};
        bool fits = true;
        for (int c = 0; c < 3; c++)
            fits = fits && (much[c] ? rgb[c] > 0.5f : rgb[c] < 0.5f);
        gi_check(&report, fits, "%s: albedo displayed as %.3f %.3f %.3f", walls[i].what,
                 (double)rgb[0], (double)rgb[1], (double)rgb[2]);
        gi_picture_finish(&picture);
    }
    gi_hide(&view);
    scene_destroy(&scene);
    gi_report_finish(&report);
}

// The means of textures, not the white of untextured materials: the atrium's floor is red and
// white.
static void test_albedo_has_textures(void **state)
{
    (void)state;
    struct gi_report report = {0};
    struct scene *scene = load_scene("atrium");
    struct frame_params params = view_params(scene, GI_METHOD_GRID, DEBUG_VIEW_VOXEL_ALBEDO);
    params.debug_face = VOXEL_FACE_POSITIVE_Y;
    test_look_down_z(&params, 0.0f);
    memcpy(params.camera.eye, (float[3]){0.0f, 8.0f, 0.01f}, sizeof(params.camera.eye));
    struct test_picture picture = gi_draw(scene, &params);
    double rgb[3];
    gi_mean(picture.pixels, picture.width, picture.height, rgb);
    gi_check(&report, rgb[0] > 1.05 * rgb[1] && rgb[1] < 0.85 && rgb[1] > 0.2,
             "floor from above: albedo displayed as %.3f %.3f %.3f", rgb[0], rgb[1], rgb[2]);
    gi_picture_finish(&picture);
    scene_destroy(&scene);
    gi_report_finish(&report);
}

// Voxels show wherever a pixel shows a surface.
static void test_opacity_covers_the_scene(void **state)
{
    (void)state;
    struct gi_report report = {0};
    struct scene *scene = load_scene("cornell");
    struct frame_params params = view_params(scene, GI_METHOD_GRID, DEBUG_VIEW_DEPTH);
    struct test_picture depth = gi_draw(scene, &params);
    params.debug_view = DEBUG_VIEW_VOXEL_OPACITY;
    struct test_picture opacity = gi_draw(scene, &params);
    uint32_t surfaces = 0, covered = 0;
    for (size_t i = 0; i < (size_t)depth.width * depth.height; i++) {
        surfaces += depth.pixels[4 * i] > 0.0f;
        covered += depth.pixels[4 * i] > 0.0f && opacity.pixels[4 * i] > 0.0f;
    }
    gi_check(&report, surfaces > 0 && covered == surfaces,
             "opacity above 0 at %u of %u pixels that show a surface", covered, surfaces);
    gi_picture_finish(&depth);
    gi_picture_finish(&opacity);
    scene_destroy(&scene);
    gi_report_finish(&report);
}

// The view of indirect diffuse light is what that light adds to the image.
static void test_indirect_light_alone_is_the_difference(void **state)
{
    (void)state;
    struct gi_report report = {0};
    struct scene *scene = load_scene("cornell");
    for (uint32_t m = 0; m < GI_PROVED_METHODS; m++) {
        struct frame_params params = view_params(scene, gi_proved_methods[m], DEBUG_VIEW_FINAL);
        params.settings.indirect_specular = false;
        double with[3], without[3], alone[3];
        struct view *view = gi_show(scene);
        struct test_picture picture = gi_draw_in(view, &params);
        gi_mean(picture.pixels, WIDTH, HEIGHT, with);
        gi_picture_finish(&picture);
        params.settings.indirect_intensity = 0.0f;
        picture = gi_draw_in(view, &params);
        gi_mean(picture.pixels, WIDTH, HEIGHT, without);
        gi_picture_finish(&picture);
        params.settings.indirect_intensity = 1.0f;
        params.debug_view = DEBUG_VIEW_INDIRECT_DIFFUSE;
        picture = gi_draw_in(view, &params);
        gi_mean(picture.pixels, WIDTH, HEIGHT, alone);
        gi_picture_finish(&picture);
        gi_hide(&view);
        for (int c = 0; c < 3; c++)
            gi_check_ratio(&report, alone[c], with[c] - without[c], 0.01, "%s, channel %d alone",
                           gi_method_names[gi_proved_methods[m]], c);
    }
    scene_destroy(&scene);
    gi_report_finish(&report);
}

// The image is grey, and the statistics say why.
static void test_blank_views_say_why(void **state)
{
    (void)state;
    struct error error = {""};
    struct renderer *renderer = test_renderer();
    struct scene *scene = load_scene("cornell");
    assert_true(renderer_set_scene(renderer, scene, &error));
    struct view *view = renderer_view_create(renderer);
    struct frame_params params = view_params(scene, GI_METHOD_NONE, DEBUG_VIEW_VOXEL_RADIANCE);
    struct test_picture picture = {0};
    assert_true(gi_converge(renderer, view, &params, &picture) > 0);
    struct frame_statistics statistics;
    renderer_view_get_statistics(renderer, view, &statistics);
    bool told = false;
    for (uint32_t i = 0; i < statistics.pass_count; i++)
        if (strcmp(statistics.passes[i].name, "debug_view") == 0)
            told = !statistics.passes[i].ran &&
                   strstr(statistics.passes[i].reason, "global illumination") != NULL;
    gi_picture_finish(&picture);
    renderer_view_destroy(renderer, &view);
    renderer_set_scene(renderer, NULL, &error);
    scene_destroy(&scene);
    assert_true(told);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_view_is_finite),
        cmocka_unit_test(test_every_level_is_finite),
        cmocka_unit_test(test_albedo_shows_the_walls),
        cmocka_unit_test(test_albedo_has_textures),
        cmocka_unit_test(test_opacity_covers_the_scene),
        cmocka_unit_test(test_indirect_light_alone_is_the_difference),
        cmocka_unit_test(test_blank_views_say_why),
    };
    return cmocka_run_group_tests(tests, NULL, test_renderer_teardown);
}
