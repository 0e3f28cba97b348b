// Proves that a copy of a scene does not change when the scene is edited and freed, shares its
// images, and can itself be edited. Uses the atrium, which has textures, lights and many nodes.
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include <string.h>

#include "renderer/scene/scene.h"
#include "renderer/import/scene_load.h"

static struct scene *load(const char *name)
{
    struct error error = {""};
    struct scene *scene = scene_create_builtin(name, &error);
    if (!scene)
        fail_msg("%s", error.message);
    return scene;
}

static void test_copies_stay(void **state)
{
    (void)state;
    struct scene *scene = load("atrium");
    struct scene *copy = scene_copy(scene), *untouched = load("atrium");
    double low[3], high[3], low_before[3], high_before[3];
    assert_non_null(copy);
    assert_true(scene->image_count > 0 && scene->light_count > 0);
    assert_memory_equal(&copy->revisions, &scene->revisions, sizeof(copy->revisions));
    assert_true(scene_bounds(scene, low_before, high_before));
    assert_ptr_equal(copy->images[0], scene->images[0]);
    struct scene_light light = scene->lights[0];
    light.intensity *= 3.0f;
    scene_set_light(scene, 0, &light);
    struct scene_material material = scene->materials[0];
    material.roughness = 0.123f;
    scene_set_material(scene, 0, &material);
    for (uint32_t i = 0; i < scene->node_count; i++)
        scene_set_node_visible(scene, i, false);
    scene->vertices[0].position[0] += 1.0f;
    scene_destroy(&scene);
    assert_true(copy->lights[0].intensity == untouched->lights[0].intensity);
    assert_true(copy->materials[0].roughness == untouched->materials[0].roughness);
    assert_true(scene_bounds(copy, low, high));
    assert_memory_equal(low, low_before, sizeof(low));
    assert_memory_equal(high, high_before, sizeof(high));
    assert_int_equal(copy->vertex_count, untouched->vertex_count);
    assert_memory_equal(copy->vertices, untouched->vertices,
                        copy->vertex_count * sizeof(copy->vertices[0]));
    assert_memory_equal(copy->indices, untouched->indices,
                        copy->index_count * sizeof(copy->indices[0]));
    assert_memory_equal(copy->images[0]->rgba, untouched->images[0]->rgba,
                        4 * (size_t)copy->images[0]->width * copy->images[0]->height);
    scene_destroy(&untouched);
    scene_destroy(&copy);
}

static void test_copies_can_be_built_on(void **state)
{
    (void)state;
    static const float origin[3] = {0.0f, 1.0f, 0.0f}, down[3] = {0.0f, -1.0f, 0.0f};
    struct scene *scene = load("cornell"), *copy = scene_copy(scene);
    struct scene_light light;
    assert_non_null(copy);
    scene_light_init(&light, SCENE_LIGHT_POINT, "added");
    for (uint32_t i = 0; i < 100; i++)
        assert_int_equal(scene_add_light(copy, &light, origin, down), scene->light_count + i);
    assert_int_equal(copy->light_count, scene->light_count + 100);
    assert_int_equal(copy->node_count, scene->node_count + 100);
    scene_destroy(&copy);
    scene_destroy(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_copies_stay),
        cmocka_unit_test(test_copies_can_be_built_on),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
