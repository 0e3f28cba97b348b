// Proves that every parameter is bound to a field of its own: sets each to two values and reads it
// back. Also that text keys of the offline tool reach the right field or are refused with reasons.
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "server/document/document.h"
#include "server/document/document_text.h"

struct fixture {
    struct scene *scene;
    struct render_settings settings;
    struct animation_state animation;
    struct view_options view;
    struct document document;
};

static int set_up(void **state)
{
    struct fixture *fixture = calloc(1, sizeof(*fixture));
    struct scene *scene = scene_create("test");
    struct scene_material material;
    scene_material_init(&material, "dull.red");
    scene_add_material(scene, &material);
    struct scene_light light;
    scene_light_init(&light, SCENE_LIGHT_POINT, "lamp");
    scene_add_light(scene, &light, (float[3]){0, 1, 0}, (float[3]){0, -1, 0});
    scene_add_node(scene, "box", SCENE_NONE);
    scene_update_world_transforms(scene);
    scene->animation_count = 1; // ids only: the tests do not play it
    render_settings_init(&fixture->settings);
    animation_state_init(&fixture->animation);
    view_options_init(&fixture->view);
    fixture->scene = scene;
    fixture->document =
        (struct document){scene, &fixture->settings, &fixture->animation, &fixture->view};
    *state = fixture;
    return 0;
}

static int tear_down(void **state)
{
    struct fixture *fixture = *state;
    fixture->scene->animation_count = 0;
    scene_destroy(&fixture->scene);
    free(fixture);
    return 0;
}

// A value inside the range, different from the default and for each component.
static struct parameter_value sample(const struct parameter *parameter, int which)
{
    struct parameter_value value = {.parameter = parameter};
    uint32_t count = parameter_component_count(parameter->type);
    for (uint32_t i = 0; i < count; i++) {
        // The eye must differ from the target.
        double fraction =
            (strcmp(parameter->name, "eye") == 0 ? 0.25 : 0.2) + 0.1 * i + 0.3 * which;
        value.numbers[i] =
            parameter->min + fraction * (fmin(parameter->max, 50.0) - parameter->min);
    }
    if (parameter->type == PARAMETER_INT)
        value.numbers[0] = fmin(parameter->max, 100.0) - 1.0 + which;
    if (parameter->type == PARAMETER_BOOL)
        value.numbers[0] = which;
    if (parameter->type == PARAMETER_ENUM)
        value.numbers[0] = which % parameter_value_count(parameter);
    if (parameter->type == PARAMETER_STRING)
        strcpy(value.text, which ? "second" : "first");
    return value;
}

static void every_parameter_round_trips(void **state)
{
    struct fixture *fixture = *state;
    for (size_t i = 0; i < parameter_count(); i++) {
        for (int which = 0; which < 2; which++) {
            struct parameter_value set = sample(parameter_at(i), which), got;
            struct rpc_error error;
            if (!document_set(&fixture->document, set.parameter->group, 0, &set, 1, &error))
                fail_msg("%s: %s", set.parameter->name, error.message);
            document_get(&fixture->document, set.parameter, 0, &got);
            assert_string_equal(got.text, set.text);
            for (int c = 0; c < 4; c++) {
                if (fabs(got.numbers[c] - set.numbers[c]) > 1e-5 * (1.0 + fabs(set.numbers[c])))
                    fail_msg("%s[%d]: %g after %g", set.parameter->name, c, got.numbers[c],
                             set.numbers[c]);
            }
        }
    }
}

static void setting_one_changes_no_other(void **state)
{
    struct fixture *fixture = *state;
    for (size_t i = 0; i < parameter_count(); i++) {
        const struct parameter *changed = parameter_at(i);
        struct parameter_value before[128], after;
        size_t count = 0;
        assert_true(parameter_count() <= 128);
        for (size_t p = 0; p < parameter_count(); p++)
            document_get(&fixture->document, parameter_at(p), 0, &before[count++]);
        struct parameter_value set = sample(changed, 1);
        struct rpc_error error;
        assert_true(document_set(&fixture->document, changed->group, 0, &set, 1, &error));
        for (size_t p = 0; p < parameter_count(); p++) {
            const struct parameter *other = parameter_at(p);
            // Node 0 carries light 0, so that their positions change together.
            bool is_placement = (other->group == GROUP_LIGHT || other->group == GROUP_NODE) &&
                                other->type != PARAMETER_COLOR &&
                                parameter_component_count(other->type) > 1;
            if (other == changed || is_placement)
                continue;
            document_get(&fixture->document, other, 0, &after);
            if (memcmp(&before[p], &after, sizeof(after)) != 0)
                fail_msg("setting %s changed %s", changed->name, other->name);
        }
    }
}

static void refuse(struct fixture *fixture, const char *key, const char *value, const char *reason)
{
    struct error error = {""};
    assert_false(
        document_set_text(fixture->scene, &fixture->settings, &fixture->view, key, value, &error));
    if (!strstr(error.message, key) || !strstr(error.message, reason))
        fail_msg("%s=%s: %s", key, value, error.message);
}

static void text_keys_reach_their_fields(void **state)
{
    struct fixture *fixture = *state;
    const char *const pairs[][2] = {
        {"lights.0.intensity", "20"},
        {"lights.lamp.range_m", "3"},
        {"materials.0.roughness", "0.25"},
        {"materials.dull.red.metallic", "0.5"},
        {"nodes.box.translation", "0,1,2"},
        {"environment.type", "constant"},
        {"exposure_ev", "1"},
        {"settings.tonemap", "aces"},
        {"gi_method", "grid"},
        {"voxel_resolution", "128"},
        {"cone_step", "0.25"},
        {"debug_face", "-y"},
        {"quality", "high"},
        {"camera.eye", "1,2,3"},
    };
    for (size_t i = 0; i < sizeof(pairs) / sizeof(pairs[0]); i++) {
        struct error error = {""};
        if (!document_set_text(fixture->scene, &fixture->settings, &fixture->view, pairs[i][0],
                               pairs[i][1], &error))
            fail_msg("%s", error.message);
    }
    assert_true(fixture->scene->lights[0].intensity == 20.0f);
    assert_true(fixture->scene->lights[0].range_m == 3.0f);
    assert_true(fixture->scene->materials[0].roughness == 0.25f);
    assert_true(fixture->scene->materials[0].metallic == 0.5f);
    assert_true(fixture->scene->nodes[1].translation[2] == 2.0f);
    assert_int_equal(fixture->scene->environment.type, SCENE_ENVIRONMENT_CONSTANT);
    assert_true(fixture->settings.exposure_ev == 1.0f);
    assert_int_equal(fixture->settings.tonemap, TONEMAP_ACES);
    assert_int_equal(fixture->settings.gi_method, GI_METHOD_GRID);
    assert_int_equal(fixture->settings.voxel_resolution, VOXEL_RESOLUTION_128);
    assert_true(fixture->settings.cone_step == 0.25f);
    assert_int_equal(fixture->view.debug_face, VOXEL_FACE_NEGATIVE_Y);
    assert_int_equal(fixture->view.quality, QUALITY_HIGH);
    assert_true(fixture->view.camera.eye[1] == 2.0f);
    refuse(fixture, "lights.7.intensity", "1", "no such light (it has 1)");
    refuse(fixture, "lights.0.intensity", "-1", "allowed are 0 to 1e+07");
    refuse(fixture, "lights.0.intensity", "nan", "out of range");
    refuse(fixture, "quality", "best", "draft, interactive, high, final");
    refuse(fixture, "cone_step", "0.1", "allowed are 0 and 0.25 to 2");
    refuse(fixture, "cone_step", "2.5", "allowed are 0 to 2");
    refuse(fixture, "lights.0", "1", "want lights.ID.FIELD");
    refuse(fixture, "colour", "1", "no such key");
    refuse(fixture, "environment.type", "equirect", "needs an image");
    refuse(fixture, "camera.target", "1,2,3", "lies in the eye");
}

static void removed_things_are_not_there(void **state)
{
    struct fixture *fixture = *state;
    struct rpc_error error;
    assert_true(document_has(&fixture->document, GROUP_LIGHT, 0, &error));
    scene_remove_light(fixture->scene, 0);
    assert_false(document_has(&fixture->document, GROUP_LIGHT, 0, &error));
    assert_string_equal(error.field, "id");
    assert_false(document_has(&fixture->document, GROUP_MATERIAL, 5, &error));
    assert_true(error.has_range && error.max == 0.0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(every_parameter_round_trips, set_up, tear_down),
        cmocka_unit_test_setup_teardown(setting_one_changes_no_other, set_up, tear_down),
        cmocka_unit_test_setup_teardown(text_keys_reach_their_fields, set_up, tear_down),
        cmocka_unit_test_setup_teardown(removed_things_are_not_there, set_up, tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
