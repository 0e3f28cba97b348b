// Proves which edits voxelize: those of lights and materials never do, motion of camera and objects
// does, and an unchanged image runs nothing at all. Reads the frame's statistics.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

#include "renderer/import/scene_load.h"
#include "support_gi.h"
#include "support_gi_scenes.h"

struct edited {
    struct renderer *renderer;
    struct view *view;
    struct scene *scene;
    struct frame_params params;
};

// Draws one frame; returns whether it voxelized.
static bool voxelizes(struct edited *edited)
{
    struct error error = {""};
    struct frame_pixels pixels;
    if (renderer_view_draw(edited->renderer, edited->view, &edited->params, &error) != RENDER_DRAWN)
        fail_msg("%s", error.message);
    assert_true(renderer_view_collect(edited->renderer, edited->view, true, &pixels));
    renderer_view_release(edited->renderer, edited->view);
    struct frame_statistics statistics;
    renderer_view_get_statistics(edited->renderer, edited->view, &statistics);
    for (uint32_t i = 0; i < statistics.pass_count; i++)
        if (strcmp(statistics.passes[i].name, "voxelize") == 0)
            return statistics.passes[i].ran;
    fail_msg("there is no pass \"voxelize\"");
    return false;
}

static void begin(struct edited *edited, enum gi_method method)
{
    struct error error = {""};
    edited->renderer = test_renderer();
    edited->scene = scene_create_builtin("cornell", &error);
    assert_non_null(edited->scene);
    assert_true(renderer_set_scene(edited->renderer, edited->scene, &error));
    edited->view = renderer_view_create(edited->renderer);
    assert_non_null(edited->view);
    edited->params = gi_params(32, 32, method);
    gi_scene_camera(edited->scene, &edited->params.camera);
    assert_true(voxelizes(edited));
    assert_false(voxelizes(edited));
    // Until light has converged for the first time, a lack of room may restart everything.
    struct test_picture picture = {0};
    assert_true(gi_converge(edited->renderer, edited->view, &edited->params, &picture) > 0);
    gi_picture_finish(&picture);
}

static void end(struct edited *edited)
{
    struct error error;
    renderer_set_scene(edited->renderer, NULL, &error);
    renderer_view_destroy(edited->renderer, &edited->view);
    scene_destroy(&edited->scene);
}

static void edit_lights(struct edited *edited)
{
    struct scene_light light;
    scene_light_init(&light, SCENE_LIGHT_POINT, "lamp");
    light.intensity = 3.0f;
    uint32_t number = scene_add_light(edited->scene, &light, (const float[3]){0.0f, 0.5f, 0.0f},
                                      (const float[3]){0.0f, -1.0f, 0.0f});
    voxelizes(edited); // a node has been added
    for (uint32_t step = 1; step < 6; step++) {
        light.intensity = 3.0f * (float)step;
        light.color[0] = 1.0f / (float)step;
        scene_set_light(edited->scene, number, &light);
        assert_false(voxelizes(edited));
        scene_set_light_placement(edited->scene, number,
                                  (const float[3]){0.0f, 0.1f * (float)step, 0.0f},
                                  (const float[3]){0.0f, -1.0f, 0.0f});
        assert_false(voxelizes(edited));
    }
}

static void edit_materials(struct edited *edited)
{
    for (uint32_t i = 0; i < edited->scene->material_count; i++) {
        struct scene_material material = edited->scene->materials[i];
        material.base_color[1] *= 0.5f;
        material.roughness = 0.3f;
        material.emissive[0] = 0.5f;
        material.emissive_strength = 2.0f;
        material.double_sided = !material.double_sided;
        scene_set_material(edited->scene, i, &material);
        assert_false(voxelizes(edited));
    }
}

static void test_edits(void **state)
{
    (void)state;
    for (uint32_t m = 0; m < GI_PROVED_METHODS; m++) {
        struct edited edited;
        begin(&edited, gi_proved_methods[m]);
        edit_lights(&edited);
        edit_materials(&edited);
        edited.params.settings.bounces = 2;
        edited.params.settings.indirect_intensity = 0.5f;
        assert_false(voxelizes(&edited));
        uint32_t node = 0;
        while (edited.scene->nodes[node].mesh == SCENE_NONE ||
               strcmp(edited.scene->nodes[node].name, "short block") != 0)
            node++;
        assert_true(node < edited.scene->node_count);
        scene_set_node_transform(edited.scene, node, (const float[3]){0.0f, 0.01f, 0.0f},
                                 (const float[4]){0.0f, 0.0f, 0.0f, 1.0f},
                                 (const float[3]){1.0f, 1.0f, 1.0f});
        assert_true(voxelizes(&edited));
        scene_set_node_visible(edited.scene, node, false);
        assert_true(voxelizes(&edited));
        scene_set_node_transform(edited.scene, node, (const float[3]){0.0f, 0.02f, 0.0f},
                                 (const float[4]){0.0f, 0.0f, 0.0f, 1.0f},
                                 (const float[3]){1.0f, 1.0f, 1.0f});
        assert_false(voxelizes(&edited)); // nobody sees it
        end(&edited);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_edits)};
    return cmocka_run_group_tests(tests, NULL, test_renderer_teardown);
}
