// Proves that the CPU displays images as the renderer does: one scene with each tone curve, with
// fixed and automatic exposure, from its linear radiance and from the GPU.
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

#include "renderer/metrics/display.h"
#include "renderer/metrics/picture.h"
#include "server/accuracy/converged_frames.h"
#include "server/accuracy/picture_file.h"
#include "server/accuracy/shot.h"
#include "support_gpu.h"

#define WIDTH  64
#define HEIGHT 48

static struct view *view;

static struct picture linear_picture(struct renderer *renderer, struct frame_params params)
{
    struct error error = {""};
    struct frame_pixels pixels;
    struct picture picture;
    params.output = FRAME_OUTPUT_LINEAR;
    if (!frames_render(renderer, view, &params, &pixels, &error))
        fail_msg("%s", error.message);
    assert_true(picture_from_pixels(&pixels, &picture));
    renderer_view_release(renderer, view);
    return picture;
}

// Largest difference between the renderer's image and ours, in steps of a byte.
static void compare(struct renderer *renderer, const struct frame_params *given,
                    const struct picture *radiance)
{
    struct frame_params params = *given;
    struct error error = {""};
    struct frame_pixels pixels;
    params.output = FRAME_OUTPUT_RGBA8;
    if (!frames_render(renderer, view, &params, &pixels, &error))
        fail_msg("%s", error.message);
    const struct render_settings *settings = &params.settings;
    bool fixed = settings->exposure_mode == EXPOSURE_FIXED;
    struct display_params display = {.exposure =
                                         exp2f(settings->exposure_ev) *
                                         (fixed ? 1.0f : display_automatic_exposure(radiance)),
                                     .tonemap = settings->tonemap,
                                     .gamma = settings->gamma};
    int worst = 0;
    for (uint32_t i = 0; i < WIDTH * HEIGHT; i++) {
        const uint8_t *shown = pixels.planes[0] + (size_t)(i / WIDTH) * pixels.row_pitch_bytes[0] +
                               (size_t)(i % WIDTH) * 4;
        float ours[3];
        display_pixel(&display, radiance->rgb + (size_t)3 * i, ours);
        for (int c = 0; c < 3; c++) {
            int difference = abs((int)shown[c] - (int)lroundf(255.0f * ours[c]));
            worst = difference > worst ? difference : worst;
        }
    }
    renderer_view_release(renderer, view);
    if (worst > 1)
        fail_msg("%s differs by %d", tonemap_names[settings->tonemap], worst);
}

static void test_displayed_pictures_agree(void **state)
{
    (void)state;
    struct error error = {""};
    struct renderer *renderer = test_renderer();
    struct scene *scene = scene_load("builtin:cornell-objects", &error);
    assert_non_null(scene);
    if (!renderer_set_scene(renderer, scene, &error))
        fail_msg("%s", error.message);
    view = renderer_view_create(renderer);
    assert_non_null(view);
    struct frame_params params = {.width = WIDTH, .height = HEIGHT, .quality = QUALITY_INTERACTIVE};
    render_settings_init(&params.settings);
    params.settings.gi_method = GI_METHOD_NONE;
    shot_default_camera(scene, (float)WIDTH / HEIGHT, &params.camera);
    struct picture radiance = linear_picture(renderer, params);
    compare(renderer, &params, &radiance);
    params.settings.exposure_ev = 1.5f;
    compare(renderer, &params, &radiance);
    params.settings.exposure_mode = EXPOSURE_FIXED;
    for (int i = 0; i < TONEMAP_COUNT; i++) {
        params.settings.tonemap = (enum tonemap)i;
        compare(renderer, &params, &radiance);
    }
    params.settings.gamma = 1.8f;
    compare(renderer, &params, &radiance);
    picture_finish(&radiance);
    renderer_view_destroy(renderer, &view);
    renderer_set_scene(renderer, NULL, &error);
    scene_destroy(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_displayed_pictures_agree)};
    return cmocka_run_group_tests(tests, NULL, test_renderer_teardown);
}
