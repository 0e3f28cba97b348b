// Proves that global illumination is planned as all else is: leaving out what a scene does not need
// changes no pixel; whatever needs an effect turns it on and, once gone, off together with its
// memory; and a converged image costs nothing more.
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "renderer/import/builtin/builtin.h"
#include "renderer/import/scene_load.h"
#include "support_gi.h"
#include "support_gi_scenes.h"

// The effects of global illumination, as statistics name them.
static const char *const effect_names[] = {
    "indirect_diffuse", "indirect_specular", "refraction", "soft_shadows",
    "bounce",           "ambient_occlusion",
};
enum {
    DIFFUSE = 1 << 0,
    SPECULAR = 1 << 1,
    REFRACTION = 1 << 2,
    SOFT_SHADOWS = 1 << 3,
    BOUNCE = 1 << 4,
    OCCLUSION = 1 << 5,
};
#define EFFECT_NAMES (sizeof(effect_names) / sizeof(effect_names[0]))

// All that may run where nothing emits light.
static const char *const unlit_passes[] = {"visibility",  "gbuffer",      "emission",
                                           "environment", "transparency", "exposure",
                                           "tonemap",     "readback",     "debug_view"};
#define UNLIT_PASSES (sizeof(unlit_passes) / sizeof(unlit_passes[0]))

// A shown scene, and what its newest frame reports.
struct stage {
    struct renderer *renderer;
    struct view *view;
    struct scene *scene;
    struct frame_params params;
    struct frame_statistics statistics;
};

static void stage_draw(struct stage *stage)
{
    struct test_picture picture = {0};
    assert_true(gi_converge(stage->renderer, stage->view, &stage->params, &picture) > 0);
    gi_picture_finish(&picture);
    renderer_view_get_statistics(stage->renderer, stage->view, &stage->statistics);
}

// Takes the scene over.
static void stage_init(struct stage *stage, struct scene *scene, enum gi_method method)
{
    struct error error = {""};
    *stage = (struct stage){.renderer = test_renderer(), .scene = scene};
    if (!renderer_set_scene(stage->renderer, scene, &error))
        fail_msg("%s", error.message);
    stage->view = renderer_view_create(stage->renderer);
    assert_non_null(stage->view);
    stage->params = gi_params(32, 32, method);
    stage->params.settings.soft_shadows = true;
    // Voxel size, number of cones and bounces matter only to time, not to which effects are on.
    stage->params.settings.voxel_resolution = VOXEL_RESOLUTION_64;
    stage->params.settings.cone_set = CONE_SET_5;
    stage->params.settings.clip_levels = 2;
    stage->params.settings.bounces = 2;
    stage->params.quality = QUALITY_HIGH; // lower ones leave soft shadows out
    test_look_down_z(&stage->params, 3.0f);
}

static void stage_finish(struct stage *stage)
{
    struct error error;
    renderer_view_destroy(stage->renderer, &stage->view);
    renderer_set_scene(stage->renderer, NULL, &error);
    scene_destroy(&stage->scene);
}

// Likewise, one frame of many, if there is anything to draw.
static void stage_draw_once(struct stage *stage)
{
    struct test_picture picture = {0};
    assert_int_not_equal(gi_draw_once(stage->renderer, stage->view, &stage->params, &picture),
                         RENDER_FAILED);
    gi_picture_finish(&picture);
    renderer_view_get_statistics(stage->renderer, stage->view, &stage->statistics);
}

// GPU memory that methods keep.
static uint64_t gi_bytes(const struct stage *stage)
{
    for (uint32_t i = 0; i < stage->statistics.memory_count; i++)
        if (strcmp(stage->statistics.memory[i].name, "gi") == 0)
            return stage->statistics.memory[i].bytes;
    return 0;
}

static uint32_t effects_on(struct gi_report *report, const struct stage *stage)
{
    uint32_t bits = 0;
    for (uint32_t name = 0; name < EFFECT_NAMES; name++) {
        bool found = false;
        for (uint32_t i = 0; i < stage->statistics.effect_count; i++)
            if (strcmp(stage->statistics.effects[i].name, effect_names[name]) == 0) {
                found = true;
                if (stage->statistics.effects[i].reason[0] == '\0')
                    gi_check(report, false, "effect %s has no reason", effect_names[name]);
                bits |= stage->statistics.effects[i].on ? 1u << name : 0u;
            }
        if (!found)
            gi_check(report, false, "there is no effect %s", effect_names[name]);
    }
    return bits;
}

static const char *describe(uint32_t bits, char out_text[160])
{
    out_text[0] = '\0';
    for (uint32_t name = 0; name < EFFECT_NAMES; name++)
        if (bits & 1u << name) {
            strcat(out_text, out_text[0] ? " " : "");
            strcat(out_text, effect_names[name]);
        }
    return out_text[0] ? out_text : "nothing";
}

// The effects that are on must be all of `must`, and may include some of `may`.
static void check_effects(struct gi_report *report, const struct stage *stage, const char *what,
                          uint32_t must, uint32_t may)
{
    uint32_t on = effects_on(report, stage);
    char texts[2][160];
    gi_check(report, (on & must) == must && (on & ~(must | may)) == 0,
             "%s, %s: on is %s; expected %s%s", gi_method_names[stage->params.settings.gi_method],
             what, describe(on, texts[0]), describe(must, texts[1]), may ? ", perhaps more" : "");
}

// Memory that was 0 before must be 0 again.
static void check_memory_freed(struct gi_report *report, const struct stage *stage,
                               const struct frame_statistics *before, const char *what)
{
    const struct frame_statistics *now = &stage->statistics;
    for (uint32_t i = 0; i < now->memory_count; i++) {
        uint64_t bytes = 0;
        for (uint32_t j = 0; j < before->memory_count; j++)
            if (strcmp(now->memory[i].name, before->memory[j].name) == 0)
                bytes = before->memory[j].bytes;
        if (bytes == 0 && now->memory[i].bytes > 0)
            gi_check(report, false, "%s, %s removed: %s still holds %llu bytes",
                     gi_method_names[stage->params.settings.gi_method], what, now->memory[i].name,
                     (unsigned long long)now->memory[i].bytes);
    }
}

// A second square above the first, facing it, hidden at first. It will become glass or an emitter.
static uint32_t add_hidden_square(struct scene *scene)
{
    struct scene_material material = scene->materials[0];
    strcpy(material.name, "object");
    uint32_t added = scene_add_material(scene, &material);
    uint32_t mesh = scene_add_mesh(scene, "object");
    const float corners[4][3] = {
        {-0.5f, 0.5f, 1.0f}, {0.5f, 0.5f, 1.0f}, {0.5f, -0.5f, 1.0f}, {-0.5f, -0.5f, 1.0f}};
    assert_true(builtin_add_quad(scene, corners, added));
    uint32_t node = builtin_add_mesh_node(scene, "object", mesh);
    scene->nodes[node].visible = false;
    scene_update_world_transforms(scene);
    return node;
}

static struct scene *lit_square_scene(float albedo, float light_radius_m)
{
    struct scene *scene = test_square_scene(1.0f, albedo);
    struct scene_light light;
    scene_light_init(&light, SCENE_LIGHT_POINT, "lamp");
    light.intensity = 10.0f;
    light.radius_m = light_radius_m;
    scene_add_light(scene, &light, (float[3]){0, 0, 2}, (float[3]){0, 0, -1});
    return scene;
}

enum change { ADD_GLASS, ADD_EMITTER, ADD_LIGHT, ADD_SOFT_LIGHT, ADD_ENVIRONMENT };

static const struct change_case {
    const char *what;
    enum change change;
    bool lit;           // there is a light already
    uint32_t must, may; // effects that turn on
} changes[] = {
    // Glass reflects, too; a scene with light has indirect light anyway.
    {"glass", ADD_GLASS, true, REFRACTION, SPECULAR},
    {"an emitter", ADD_EMITTER, false, DIFFUSE | BOUNCE, SOFT_SHADOWS},
    {"a second light", ADD_LIGHT, true, 0, 0},
    {"a light", ADD_LIGHT, false, DIFFUSE | BOUNCE, 0},
    {"a light with a size", ADD_SOFT_LIGHT, true, SOFT_SHADOWS, 0},
    {"an environment", ADD_ENVIRONMENT, false, DIFFUSE | BOUNCE, 0},
};

static void set_object(struct scene *scene, uint32_t node, enum change change)
{
    uint32_t id = scene->material_count - 1;
    struct scene_material material = scene->materials[id];
    if (change == ADD_GLASS) {
        material.transmission = 1.0f;
        material.ior = 1.5f;
        material.roughness = 0.0f;
        material.thickness_m = 0.05f;
    } else {
        material.emissive[0] = material.emissive[1] = material.emissive[2] = 1.0f;
        material.emissive_strength = 5.0f;
    }
    scene_set_material(scene, id, &material);
    scene_set_node_visible(scene, node, true);
}

static void set_environment(struct scene *scene, enum scene_environment_type type)
{
    struct scene_environment environment = {
        .type = type, .intensity = 1.0f, .color = {1.0f, 1.0f, 1.0f}};
    scene_set_environment(scene, &environment);
}

// Makes the change, draws, undoes it as a user would, and draws again.
static void apply_and_undo(struct gi_report *report, struct stage *stage, uint32_t node,
                           const struct change_case *c, uint32_t before)
{
    struct scene *scene = stage->scene;
    uint32_t object = scene->material_count - 1, light_id = SCENE_NONE;
    struct scene_material matte = scene->materials[object];
    bool is_object = c->change == ADD_GLASS || c->change == ADD_EMITTER;
    if (is_object) {
        set_object(scene, node, c->change);
    } else if (c->change == ADD_ENVIRONMENT) {
        set_environment(scene, SCENE_ENVIRONMENT_CONSTANT);
    } else {
        struct scene_light light;
        scene_light_init(&light, SCENE_LIGHT_POINT, "added");
        light.intensity = 5.0f;
        light.radius_m = c->change == ADD_SOFT_LIGHT ? 0.1f : 0.0f;
        light_id = scene_add_light(scene, &light, (float[3]){0.5f, 0, 2}, (float[3]){0, 0, -1});
    }
    stage_draw(stage);
    check_effects(report, stage, c->what, before | c->must, c->may);
    if (is_object) {
        scene_set_node_visible(scene, node, false);
        scene_set_material(scene, object, &matte);
    } else if (c->change == ADD_ENVIRONMENT) {
        set_environment(scene, SCENE_ENVIRONMENT_NONE);
    } else {
        scene_remove_light(scene, light_id);
    }
    stage_draw(stage);
}

static void test_each_thing_turns_on_its_effect(void **state)
{
    (void)state;
    struct gi_report report = {0};
    for (uint32_t m = 0; m < GI_PROVED_METHODS; m++)
        for (size_t i = 0; i < sizeof(changes) / sizeof(changes[0]); i++) {
            const struct change_case *c = &changes[i];
            struct stage stage;
            struct scene *scene =
                c->lit ? lit_square_scene(0.5f, 0.0f) : test_square_scene(1.0f, 0.5f);
            uint32_t node = add_hidden_square(scene);
            stage_init(&stage, scene, gi_proved_methods[m]);
            stage_draw(&stage);
            uint32_t before = c->lit ? DIFFUSE | BOUNCE : 0;
            check_effects(&report, &stage, c->lit ? "lit square" : "dark square", before, 0);
            struct frame_statistics first = stage.statistics;
            apply_and_undo(&report, &stage, node, c, before);
            char what[64];
            snprintf(what, sizeof(what), "%s removed", c->what);
            check_effects(&report, &stage, what, before, 0);
            check_memory_freed(&report, &stage, &first, c->what);
            stage_finish(&stage);
        }
    gi_report_finish(&report);
}

// Memory is freed again even if all of global illumination is switched off.
static void test_switching_off_frees_memory(void **state)
{
    (void)state;
    struct gi_report report = {0};
    for (uint32_t m = 0; m < GI_PROVED_METHODS; m++) {
        struct stage stage;
        stage_init(&stage, lit_square_scene(0.5f, 0.0f), GI_METHOD_NONE);
        stage_draw(&stage);
        struct frame_statistics first = stage.statistics;
        check_effects(&report, &stage, "method none", 0, 0);
        stage.params.settings.gi_method = gi_proved_methods[m];
        stage_draw(&stage);
        check_effects(&report, &stage, "switched on", DIFFUSE | BOUNCE, 0);
        stage.params.settings.gi_method = GI_METHOD_NONE;
        stage_draw(&stage);
        check_effects(&report, &stage, "switched off", 0, 0);
        check_memory_freed(&report, &stage, &first, gi_method_names[gi_proved_methods[m]]);
        gi_check(&report, gi_bytes(&stage) == 0, "%s to none: methods keep %llu bytes",
                 gi_method_names[gi_proved_methods[m]], (unsigned long long)gi_bytes(&stage));
        stage_finish(&stage);
    }
    gi_report_finish(&report);
}

// What the method before kept for the view goes when another draws it, whichever it is.
static void test_switching_methods_frees_memory(void **state)
{
    (void)state;
    struct gi_report report = {0};
    struct stage stage;
    stage_init(&stage, lit_square_scene(0.5f, 0.0f), GI_METHOD_NONE);
    uint64_t bytes[GI_METHOD_COUNT];
    for (uint32_t from = 0; from < GI_METHOD_COUNT; from++)
        for (uint32_t to = 0; to < GI_METHOD_COUNT; to++) {
            stage.params.settings.gi_method = (enum gi_method)from;
            stage_draw_once(&stage);
            if (to == 0)
                bytes[from] = gi_bytes(&stage);
            gi_check(&report, gi_bytes(&stage) == bytes[from],
                     "%s: %llu bytes, whatever was drawn before (%llu at first)",
                     gi_method_names[from], (unsigned long long)gi_bytes(&stage),
                     (unsigned long long)bytes[from]);
            stage.params.settings.gi_method = (enum gi_method)to;
            stage_draw_once(&stage);
        }
    gi_check(&report, bytes[GI_METHOD_NONE] == 0, "none keeps nothing");
    for (uint32_t m = 0; m < GI_PROVED_METHODS; m++)
        gi_check(&report, bytes[gi_proved_methods[m]] > 0, "%s keeps something",
                 gi_method_names[gi_proved_methods[m]]);
    stage_finish(&stage);
    gi_report_finish(&report);
}

static void test_settings_turn_effects_off(void **state)
{
    (void)state;
    struct gi_report report = {0};
    for (uint32_t m = 0; m < GI_PROVED_METHODS; m++) {
        struct stage stage;
        struct scene *scene = lit_square_scene(0.5f, 0.1f);
        scene->materials[0].ior = 1.5f;
        scene->materials[0].roughness = 0.1f;
        stage_init(&stage, scene, gi_proved_methods[m]);
        stage.params.settings.ambient_occlusion = true;
        stage_draw(&stage);
        check_effects(&report, &stage, "gloss, lamp with a size, occlusion wanted",
                      DIFFUSE | BOUNCE | SPECULAR | SOFT_SHADOWS | OCCLUSION, 0);
        stage.params.settings.ambient_occlusion = false;
        stage.params.settings.soft_shadows = false;
        stage.params.settings.indirect_specular = false;
        stage_draw(&stage);
        check_effects(&report, &stage, "all of these switched off", DIFFUSE | BOUNCE, 0);
        stage.params.settings.bounces = 1;
        stage_draw(&stage);
        check_effects(&report, &stage, "one bounce", DIFFUSE, 0);
        stage_finish(&stage);
    }
    gi_report_finish(&report);
}

static void test_unlit_scenes_run_no_light(void **state)
{
    (void)state;
    struct gi_report report = {0};
    for (uint32_t m = 0; m < GI_PROVED_METHODS; m++) {
        struct stage stage;
        struct scene *scene = lit_square_scene(0.5f, 0.1f);
        scene->materials[0].shading = SCENE_SHADING_UNLIT;
        stage_init(&stage, scene, gi_proved_methods[m]);
        stage_draw(&stage);
        check_effects(&report, &stage, "unlit materials", 0, 0);
        for (uint32_t i = 0; i < stage.statistics.pass_count; i++) {
            const struct pass_statistics *pass = &stage.statistics.passes[i];
            bool known = false;
            for (uint32_t j = 0; j < UNLIT_PASSES; j++)
                known = known || strcmp(pass->name, unlit_passes[j]) == 0;
            if (pass->ran && !known)
                gi_check(&report, false, "%s, unlit materials: pass %s ran",
                         gi_method_names[gi_proved_methods[m]], pass->name);
        }
        stage_finish(&stage);
    }
    gi_report_finish(&report);
}

static void test_black_scenes_bounce_nothing(void **state)
{
    (void)state;
    struct gi_report report = {0};
    for (uint32_t m = 0; m < GI_PROVED_METHODS; m++) {
        struct stage stage;
        stage_init(&stage, lit_square_scene(0.0f, 0.0f), gi_proved_methods[m]);
        stage_draw(&stage);
        // A black surface receives nothing either.
        check_effects(&report, &stage, "black", 0, DIFFUSE);
        stage_finish(&stage);
    }
    gi_report_finish(&report);
}

static void check_planned_is_forced(struct gi_report *report, const char *name,
                                    enum gi_method method)
{
    struct error error = {""};
    struct scene *scene = scene_create_builtin(name, &error);
    assert_non_null(scene);
    struct frame_params params = gi_params(64, 36, method);
    params.output = FRAME_OUTPUT_RGBA8;
    params.settings.soft_shadows = true;
    // What is left out does not depend on voxel size, cones and bounces; the time of this test
    // does.
    params.settings.voxel_resolution = VOXEL_RESOLUTION_64;
    params.settings.cone_set = CONE_SET_5;
    params.settings.clip_levels = 2;
    params.settings.bounces = 2;
    gi_scene_camera(scene, &params.camera);
    struct test_picture planned = gi_draw(scene, &params);
    params.settings.force_all_effects = true;
    struct test_picture forced = gi_draw(scene, &params);
    double largest = 0.0;
    for (size_t i = 0; i < (size_t)planned.width * planned.height * 4; i++)
        largest = fmax(largest, fabs((double)planned.pixels[i] - forced.pixels[i]));
    gi_check(report, largest <= 1.0, "%s, %s: planned differs from forced by %g of 255 (within 1)",
             gi_method_names[method], name, largest);
    gi_picture_finish(&planned);
    gi_picture_finish(&forced);
    scene_destroy(&scene);
}

// The first two scenes with every method, each of the others with one method in turn; all with
// VOXCAST_TEST_FULL=1.
static void test_left_out_effects_change_no_pixel(void **state)
{
    (void)state;
    struct gi_report report = {0};
    for (uint32_t i = 0; scene_builtin_name(i); i++)
        for (uint32_t m = 0; m < GI_PROVED_METHODS; m++)
            if (i < 2 || i % GI_PROVED_METHODS == m || gi_test_is_full())
                check_planned_is_forced(&report, scene_builtin_name(i), gi_proved_methods[m]);
    gi_report_finish(&report);
}

// gi_converge() waits for RENDER_UNCHANGED; it must stay so until something changes.
static void test_converged_pictures_rest(void **state)
{
    (void)state;
    struct gi_report report = {0};
    for (uint32_t m = 0; m < GI_PROVED_METHODS; m++) {
        struct error error = {""};
        struct stage stage;
        stage_init(&stage, scene_create_builtin("cornell", &error), gi_proved_methods[m]);
        gi_scene_camera(stage.scene, &stage.params.camera);
        struct test_picture picture = {0};
        uint32_t frames = gi_converge(stage.renderer, stage.view, &stage.params, &picture);
        gi_picture_finish(&picture);
        uint32_t drawn = 0;
        for (int i = 0; i < 5; i++)
            drawn += renderer_view_draw(stage.renderer, stage.view, &stage.params, &error) !=
                     RENDER_UNCHANGED;
        const char *method = gi_method_names[gi_proved_methods[m]];
        gi_check(&report, drawn == 0, "%s: converged after %u frames, then %u of 5 drawn", method,
                 frames, drawn);
        struct scene_material key_light = stage.scene->materials[5];
        key_light.emissive_strength *= 2.0f;
        scene_set_material(stage.scene, 5, &key_light);
        frames = gi_converge(stage.renderer, stage.view, &stage.params, &picture);
        gi_picture_finish(&picture);
        gi_check(&report, frames > 0, "%s: converged anew after %u frames", method, frames);
        stage_finish(&stage);
    }
    gi_report_finish(&report);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_each_thing_turns_on_its_effect),
        cmocka_unit_test(test_switching_off_frees_memory),
        cmocka_unit_test(test_switching_methods_frees_memory),
        cmocka_unit_test(test_settings_turn_effects_off),
        cmocka_unit_test(test_unlit_scenes_run_no_light),
        cmocka_unit_test(test_black_scenes_bounce_nothing),
        cmocka_unit_test(test_left_out_effects_change_no_pixel),
        cmocka_unit_test(test_converged_pictures_rest),
    };
    return cmocka_run_group_tests(tests, NULL, test_renderer_teardown);
}
