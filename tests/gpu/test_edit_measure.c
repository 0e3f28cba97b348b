// Proves the measurement of edits: with direct light alone an image follows an edit in one frame;
// with voxels the first of the change is there in one frame, and the stages come in order. The
// scene is afterwards as it was before, and what cannot be measured is refused with a reason.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

#include "server/accuracy/edit_latency.h"
#include "server/accuracy/shot.h"
#include "support_gpu.h"

#define EMITTER 5 // the light's material in builtin:cornell

static struct frame_params frame_of(const struct scene *scene, enum gi_method method)
{
    struct frame_params params = {.width = 32, .height = 18, .quality = QUALITY_DRAFT};
    render_settings_init(&params.settings);
    params.settings.gi_method = method;
    shot_default_camera(scene, 32.0f / 18.0f, &params.camera);
    return params;
}

static struct scene *show(const char *source)
{
    struct error error = {""};
    struct scene *scene = scene_load(source, &error);
    if (!scene || !renderer_set_scene(test_renderer(), scene, &error))
        fail_msg("%s", error.message);
    return scene;
}

static void hide(struct scene *scene)
{
    struct error error = {""};
    assert_true(renderer_set_scene(test_renderer(), NULL, &error));
    scene_destroy(&scene);
}

static double frames(const struct edit_result *result, enum edit_stage stage)
{
    return samples_quantile(&result->frames[stage], 1.0);
}

static void test_direct_light_is_there_at_once(void **state)
{
    (void)state;
    struct error error = {""};
    struct edit_result result;
    struct scene *scene = show("builtin:cornell");
    struct frame_params frame = frame_of(scene, GI_METHOD_NONE);
    struct scene_material before = scene->materials[EMITTER];
    for (int kind = 0; kind < EDIT_KIND_COUNT; kind++) {
        struct edit_params params = {.renderer = test_renderer(),
                                     .scene = scene,
                                     .frame = &frame,
                                     .kind = (enum edit_kind)kind,
                                     .light = SCENE_NONE,
                                     .material = SCENE_NONE,
                                     .repetitions = 2};
        if (!edit_measure(&params, &result, &error))
            fail_msg("%s", error.message);
        assert_int_equal(result.material, EMITTER);
        assert_int_equal(result.ms[EDIT_FIRST].count, 2);
        assert_true(frames(&result, EDIT_FIRST) == 1.0);
        assert_true(frames(&result, EDIT_ARRIVED) == 1.0);
        assert_true(result.change > 0.001 && result.change < 1.0);
        edit_result_finish(&result);
    }
    assert_memory_equal(before.emissive, scene->materials[EMITTER].emissive,
                        sizeof(before.emissive));
    assert_true(before.emissive_strength == scene->materials[EMITTER].emissive_strength);
    hide(scene);
}

static void test_indirect_light_follows(void **state)
{
    (void)state;
    struct error error = {""};
    struct edit_result result;
    struct scene *scene = show("builtin:cornell");
    struct frame_params frame = frame_of(scene, GI_METHOD_GRID);
    struct edit_params params = {.renderer = test_renderer(),
                                 .scene = scene,
                                 .frame = &frame,
                                 .kind = EDIT_INTENSITY,
                                 .light = SCENE_NONE,
                                 .material = EMITTER,
                                 .repetitions = 2};
    if (!edit_measure(&params, &result, &error))
        fail_msg("%s", error.message);
    assert_true(frames(&result, EDIT_FIRST) == 1.0);
    assert_true(frames(&result, EDIT_INDIRECT) > 1.0);
    assert_true(frames(&result, EDIT_INDIRECT) <= frames(&result, EDIT_SETTLED));
    assert_true(frames(&result, EDIT_ARRIVED) <= frames(&result, EDIT_SETTLED));
    for (uint32_t i = 0; i < 2; i++) {
        assert_true(result.ms[EDIT_FIRST].values[i] > 0.0);
        assert_true(result.ms[EDIT_FIRST].values[i] <= result.ms[EDIT_ARRIVED].values[i]);
        assert_true(result.ms[EDIT_ARRIVED].values[i] <= result.ms[EDIT_SETTLED].values[i]);
    }
    edit_result_finish(&result);
    hide(scene);
}

// Tries to measure what cannot be measured; the message must name the reason.
static void assert_refused(struct edit_params *params, const char *reason)
{
    struct error error = {""};
    struct edit_result result;
    assert_false(edit_measure(params, &result, &error));
    if (!strstr(error.message, reason))
        fail_msg("\"%s\" does not say \"%s\"", error.message, reason);
    edit_result_finish(&result);
}

static void test_what_cannot_be_measured(void **state)
{
    (void)state;
    struct scene *scene = show("builtin:cornell");
    struct frame_params frame = frame_of(scene, GI_METHOD_NONE);
    struct edit_params params = {.renderer = test_renderer(),
                                 .scene = scene,
                                 .frame = &frame,
                                 .light = 7,
                                 .material = SCENE_NONE,
                                 .repetitions = 1};
    assert_refused(&params, "light 7");
    params.light = SCENE_NONE;
    params.material = 0;
    assert_refused(&params, "material 0");
    params.light = params.material = EMITTER;
    assert_refused(&params, "exclude");
    // A view that sees nothing of the edit.
    params.light = SCENE_NONE;
    memcpy(frame.camera.target, (float[3]){0.0f, 0.0f, 100.0f}, sizeof(frame.camera.target));
    assert_refused(&params, "too little");
    struct scene_material dark = scene->materials[EMITTER];
    dark.emissive_strength = 0.0f;
    scene_set_material(scene, EMITTER, &dark);
    params.material = SCENE_NONE;
    assert_refused(&params, "nothing in the scene shines");
    hide(scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_direct_light_is_there_at_once),
        cmocka_unit_test(test_indirect_light_follows),
        cmocka_unit_test(test_what_cannot_be_measured),
    };
    return cmocka_run_group_tests(tests, NULL, test_renderer_teardown);
}
