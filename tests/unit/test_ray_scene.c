// Proves that rays hit the triangles that are drawn: nearest hit, placement, mirrored and singular
// nodes, visibility, alpha-masked holes, and refusal of arguments that are not finite. Uses scenes
// of one or two quads with hits known by hand, and the published Cornell box where present.
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "renderer/scene/ray_scene.h"
#include "renderer/import/importers.h"
#include "renderer/import/scene_load.h"
#include "support_scenes.h"

#define TOLERANCE 1e-5f

static const float NO_ROTATION[4] = {0, 0, 0, 1};

// A quad from (-1, -1) to (1, 1) in the plane z = 0, facing +Z, transformed by node 0.
static struct scene *make_quad(const struct scene_material *material)
{
    struct scene *scene = scene_create("quad");
    assert_non_null(scene);
    struct scene_vertex vertices[4] = {0};
    for (int i = 0; i < 4; i++) {
        struct scene_vertex *vertex = &vertices[i];
        vertex->position[0] = i == 1 || i == 2 ? 1 : -1;
        vertex->position[1] = i >= 2 ? 1 : -1;
        vertex->normal[2] = 1;
        vertex->uv[0][0] = vertex->position[0] * 0.5f + 0.5f;
        vertex->uv[0][1] = vertex->position[1] * 0.5f + 0.5f;
        vertex->color[3] = 1;
    }
    const uint32_t indices[6] = {0, 1, 2, 0, 2, 3};
    assert_int_equal(scene_add_material(scene, material), 0);
    assert_int_equal(scene_add_mesh(scene, "quad"), 0);
    assert_int_equal(scene_add_primitive(scene, vertices, 4, indices, 6, 0), 0);
    assert_int_equal(scene_add_node(scene, "quad", SCENE_NONE), 0);
    scene->nodes[0].mesh = 0;
    scene_update_world_transforms(scene);
    return scene;
}

// By batches of one ray.
static bool is_occluded(const struct ray_scene *ray_scene, const struct ray *ray,
                        ray_scene_stops_light *stops_light, void *context)
{
    struct ray_batch batch;
    ray_batch_init(&batch, ray_scene, false);
    ray_batch_add(&batch, ray);
    ray_scene_occlude_all(ray_scene, &batch, stops_light, context);
    return ray_batch_is_occluded(&batch, 0);
}

static bool find(const struct ray_scene *ray_scene, const struct ray *ray,
                 struct ray_crossing *out_crossing)
{
    struct ray_batch batch;
    ray_batch_init(&batch, ray_scene, false);
    ray_batch_add(&batch, ray);
    ray_scene_find_all(ray_scene, &batch);
    return ray_scene_get_crossing(ray_scene, &batch, 0, out_crossing);
}

static bool cast_down(const struct ray_scene *ray_scene, float x, float y, struct ray_hit *out_hit)
{
    return ray_scene_intersect(ray_scene, (float[3]){x, y, 5}, (float[3]){0, 0, -2}, 100, out_hit);
}

static void test_hit_is_described(void **state)
{
    (void)state;
    struct scene_material material;
    scene_material_init(&material, "white");
    struct scene *scene = make_quad(&material);
    struct ray_scene *ray_scene = ray_scene_create(scene);
    assert_non_null(ray_scene);
    struct ray_hit hit;
    assert_true(cast_down(ray_scene, 0.5f, -0.25f, &hit));
    assert_int_equal(hit.node, 0);
    assert_int_equal(hit.primitive, 0);
    assert_int_equal(hit.triangle, 0);
    assert_int_equal(hit.material, 0);
    assert_float_equal(hit.distance, 2.5f, TOLERANCE); // directions of length 2
    assert_float_equal(hit.position[0], 0.5f, TOLERANCE);
    assert_float_equal(hit.position[2], 0, TOLERANCE);
    assert_float_equal(hit.normal[2], 1, TOLERANCE);
    // The triangle's corners are (-1,-1), (1,-1), (1,1).
    assert_float_equal(hit.barycentric[0], 0.375f, TOLERANCE);
    assert_float_equal(hit.barycentric[1], 0.375f, TOLERANCE);
    assert_false(cast_down(ray_scene, 1.5f, 0, &hit));
    assert_false(
        ray_scene_intersect(ray_scene, (float[3]){0, 0, 5}, (float[3]){0, 0, -2}, 2.4f, &hit));
    // From behind, the normal faces the ray.
    assert_true(
        ray_scene_intersect(ray_scene, (float[3]){0, 0, -5}, (float[3]){0, 0, 1}, 100, &hit));
    assert_float_equal(hit.normal[2], -1, TOLERANCE);
    ray_scene_destroy(&ray_scene);
    assert_null(ray_scene);
    scene_destroy(&scene);
}

static void test_placement_and_visibility(void **state)
{
    (void)state;
    struct scene_material material;
    scene_material_init(&material, "white");
    struct scene *scene = make_quad(&material);
    struct ray_scene *ray_scene = ray_scene_create(scene);
    struct ray_hit hit;
    // Mirrored in X, three times as wide, one metre up.
    scene_set_node_transform(scene, 0, (float[3]){0, 0, 1}, NO_ROTATION, (float[3]){-3, 1, 1});
    ray_scene_update_transforms(ray_scene);
    assert_true(cast_down(ray_scene, 2.5f, 0, &hit));
    assert_float_equal(hit.position[2], 1, TOLERANCE);
    assert_float_equal(hit.normal[2], 1, TOLERANCE);
    // A scale of 0 cannot be hit, nor can a hidden node.
    scene_set_node_transform(scene, 0, (float[3]){0, 0, 0}, NO_ROTATION, (float[3]){1, 0, 1});
    ray_scene_update_transforms(ray_scene);
    assert_false(cast_down(ray_scene, 0.1f, 0, &hit));
    scene_set_node_transform(scene, 0, (float[3]){0, 0, 0}, NO_ROTATION, (float[3]){1, 1, 1});
    scene_set_node_visible(scene, 0, false);
    ray_scene_update_transforms(ray_scene);
    assert_false(cast_down(ray_scene, 0.1f, 0, &hit));
    scene_set_node_visible(scene, 0, true);
    ray_scene_update_transforms(ray_scene);
    assert_true(cast_down(ray_scene, 0.1f, 0, &hit));
    ray_scene_destroy(&ray_scene);
    scene_destroy(&scene);
}

static void test_holes_of_masks(void **state)
{
    (void)state;
    struct scene_material material;
    scene_material_init(&material, "mask");
    material.alpha_mode = SCENE_ALPHA_MASK;
    material.alpha_cutoff = 0.5f;
    struct scene_texture *texture = &material.textures[SCENE_TEXTURE_BASE_COLOR];
    *texture = (struct scene_texture){.image = 0, .nearest = true, .scale = {1, 1}};
    struct scene *scene = make_quad(&material);
    // Left column opaque, right column a hole.
    uint8_t *rgba = malloc(2 * 4);
    assert_non_null(rgba);
    memcpy(rgba, (uint8_t[8]){255, 255, 255, 255, 255, 255, 255, 0}, 8);
    struct image *image = image_create(2, 1, rgba);
    assert_int_equal(scene_add_image(scene, image), 0);
    image_release(&image);
    struct ray_scene *ray_scene = ray_scene_create(scene);
    struct ray_hit hit;
    assert_true(cast_down(ray_scene, -0.5f, 0.1f, &hit));
    assert_false(cast_down(ray_scene, 0.5f, 0.1f, &hit));
    // The same image has no effect on an opaque material; with a shifted texture the hole moves.
    material.alpha_mode = SCENE_ALPHA_OPAQUE;
    scene_set_material(scene, 0, &material);
    ray_scene_update_materials(ray_scene);
    assert_true(cast_down(ray_scene, 0.5f, 0.1f, &hit));
    material.alpha_mode = SCENE_ALPHA_MASK;
    material.textures[SCENE_TEXTURE_BASE_COLOR].offset[0] = 0.5f;
    scene_set_material(scene, 0, &material);
    ray_scene_update_materials(ray_scene);
    assert_true(cast_down(ray_scene, 0.5f, 0.1f, &hit));
    assert_false(cast_down(ray_scene, -0.5f, 0.1f, &hit));
    // Shadows have the same holes.
    const struct ray through = {{-0.5f, 0.1f, 5}, {0, 0, -1}, 100};
    const struct ray blocked = {{0.5f, 0.1f, 5}, {0, 0, -1}, 100};
    assert_false(is_occluded(ray_scene, &through, NULL, NULL));
    assert_true(is_occluded(ray_scene, &blocked, NULL, NULL));
    ray_scene_destroy(&ray_scene);
    scene_destroy(&scene);
}

struct asked {
    uint32_t count;
    struct ray_crossing last;
    bool stops;
};

static bool note_crossing(void *context, uint32_t ray, const struct ray_crossing *crossing)
{
    (void)ray;
    struct asked *asked = context;
    asked->count++;
    asked->last = *crossing;
    return asked->stops;
}

static void test_occlusion_asks_what_lets_light_pass(void **state)
{
    (void)state;
    struct scene_material material;
    scene_material_init(&material, "pane");
    struct scene *scene = make_quad(&material);
    const struct ray ray = {{0.5f, -0.25f, 5}, {0, 0, -2}, 100};
    const struct ray beside = {{1.5f, 0, 5}, {0, 0, -2}, 100};
    const struct ray shorter = {{0.5f, -0.25f, 5}, {0, 0, -2}, 2.4f};
    for (int passes = 0; passes < 2; passes++) {
        const bool lets_light_pass[1] = {passes == 1};
        struct ray_scene *ray_scene = ray_scene_create_for_light(
            &(struct ray_scene_params){.scene = scene, .lets_light_pass = lets_light_pass});
        assert_non_null(ray_scene);
        struct asked asked = {.stops = false};
        assert_true(is_occluded(ray_scene, &ray, note_crossing, &asked) == !passes);
        assert_int_equal(asked.count, passes);
        assert_true(is_occluded(ray_scene, &ray, NULL, NULL) == !passes);
        asked = (struct asked){.stops = true};
        assert_true(is_occluded(ray_scene, &ray, note_crossing, &asked));
        assert_int_equal(asked.count, passes);
        assert_false(is_occluded(ray_scene, &beside, note_crossing, &asked));
        assert_false(is_occluded(ray_scene, &shorter, note_crossing, &asked));
        assert_int_equal(asked.count, passes);
        // Nearest hits are found in any case.
        struct ray_crossing crossing;
        assert_true(find(ray_scene, &ray, &crossing));
        assert_float_equal(crossing.distance, 2.5f, TOLERANCE);
        assert_float_equal(crossing.barycentric[0], 0.375f, TOLERANCE);
        assert_false(find(ray_scene, &shorter, &crossing));
        if (passes) {
            assert_float_equal(asked.last.distance, 2.5f, TOLERANCE);
            assert_float_equal(asked.last.barycentric[1], 0.375f, TOLERANCE);
        }
        const struct ray_load load[3] = {{ray, false}, {beside, false}, {shorter, true}};
        assert_int_equal(ray_scene_cast_all(ray_scene, load, 3), 1);
        ray_scene_destroy(&ray_scene);
    }
    scene_destroy(&scene);
}

#define ROW 8

// Rays straight down onto the quad and beside it, in a square of ROW x ROW.
static void fill_square(const struct ray_scene *ray_scene, uint32_t count, bool coherent,
                        struct ray_batch *batch)
{
    ray_batch_init(batch, ray_scene, coherent);
    for (uint32_t i = 0; i < count; i++) {
        float x = -1.155f + 0.33f * (float)(i % ROW), y = -1.155f + 0.33f * (float)(i / ROW);
        const struct ray ray = {{x, y, 5}, {0, 0, -1}, 100};
        ray_batch_add(batch, &ray);
    }
}

static bool is_on_quad(uint32_t i)
{
    return i % ROW > 0 && i % ROW < ROW - 1 && i / ROW > 0 && i / ROW < ROW - 1;
}

// Stops every third ray, and checks which one it is asked about.
static bool stop_some(void *context, uint32_t ray, const struct ray_crossing *crossing)
{
    (void)context;
    float x = -1.155f + 0.33f * (float)(ray % ROW), y = -1.155f + 0.33f * (float)(ray / ROW);
    float u = crossing->barycentric[0], v = crossing->barycentric[1];
    // Corners (-1,-1), (1,-1), (1,1) or (-1,-1), (1,1), (-1,1).
    bool first = crossing->triangle == 0;
    assert_float_equal(first ? u + v : u, (x + 1) / 2, TOLERANCE);
    assert_float_equal(first ? v : u + v, (y + 1) / 2, TOLERANCE);
    assert_float_equal(crossing->distance, 5, TOLERANCE);
    return ray % 3 == 0;
}

static void test_batches_of_any_size_find_what_single_rays_do(void **state)
{
    (void)state;
    struct scene_material material;
    scene_material_init(&material, "pane");
    struct scene *scene = make_quad(&material);
    const bool lets_light_pass[1] = {true};
    struct ray_scene *ray_scene = ray_scene_create_for_light(
        &(struct ray_scene_params){.scene = scene, .lets_light_pass = lets_light_pass});
    for (uint32_t count = 1; count <= RAY_BATCH_SIZE; count++)
        for (int coherent = 0; coherent < 2; coherent++) {
            struct ray_batch batch;
            fill_square(ray_scene, count, coherent, &batch);
            ray_scene_find_all(ray_scene, &batch);
            for (uint32_t i = 0; i < count; i++) {
                struct ray_crossing crossing;
                bool found = ray_scene_get_crossing(ray_scene, &batch, i, &crossing);
                assert_int_equal(found, is_on_quad(i));
                if (found)
                    stop_some(NULL, i, &crossing);
            }
            fill_square(ray_scene, count, coherent, &batch);
            ray_scene_occlude_all(ray_scene, &batch, stop_some, NULL);
            for (uint32_t i = 0; i < count; i++)
                assert_int_equal(ray_batch_is_occluded(&batch, i), is_on_quad(i) && i % 3 == 0);
            fill_square(ray_scene, count, coherent, &batch);
            ray_scene_occlude_all(ray_scene, &batch, NULL, NULL);
            for (uint32_t i = 0; i < count; i++)
                assert_false(ray_batch_is_occluded(&batch, i));
        }
    ray_scene_destroy(&ray_scene);
    scene_destroy(&scene);
}

static void test_arguments_that_are_not_finite(void **state)
{
    (void)state;
    struct scene_material material;
    scene_material_init(&material, "white");
    struct scene *scene = make_quad(&material);
    struct ray_scene *ray_scene = ray_scene_create(scene);
    struct ray_hit hit = {.node = 77};
    const float origin[3] = {0, 0, 5}, down[3] = {0, 0, -1}, zero[3] = {0};
    assert_false(ray_scene_intersect(ray_scene, (float[3]){NAN, 0, 5}, down, 100, &hit));
    assert_false(ray_scene_intersect(ray_scene, origin, (float[3]){0, INFINITY, -1}, 100, &hit));
    assert_false(ray_scene_intersect(ray_scene, origin, down, INFINITY, &hit));
    assert_false(ray_scene_intersect(ray_scene, origin, down, NAN, &hit));
    assert_false(ray_scene_intersect(ray_scene, origin, down, -1, &hit));
    assert_false(ray_scene_intersect(ray_scene, origin, zero, 100, &hit));
    assert_int_equal(hit.node, 77);
    ray_scene_destroy(&ray_scene);
    scene_destroy(&scene);
}

static void test_empty_scene(void **state)
{
    (void)state;
    struct scene *scene = scene_create("empty");
    struct ray_scene *ray_scene = ray_scene_create(scene);
    struct ray_hit hit;
    assert_non_null(ray_scene);
    assert_false(cast_down(ray_scene, 0, 0, &hit));
    ray_scene_destroy(&ray_scene);
    scene_destroy(&scene);
}

static void test_cornell_box(void **state)
{
    (void)state;
    const char *path = support_scene_path("cornell/cornell.glb");
    if (!path) {
        skip();
    }
    struct error error;
    struct scene *scene = scene_import_gltf(path, &error);
    assert_non_null(scene);
    struct ray_scene *ray_scene = ray_scene_create(scene);
    float eye[3], target[3], up[3], direction[3];
    scene_get_camera_placement(scene, 0, eye, target, up);
    for (int axis = 0; axis < 3; axis++) {
        direction[axis] = target[axis] - eye[axis];
    }
    struct ray_hit hit;
    assert_true(ray_scene_intersect(ray_scene, eye, direction, 100, &hit));
    assert_true(hit.distance > 0.8f && hit.distance < 1.4f); // the box is 0.559 m deep, 0.8 m off
    ray_scene_destroy(&ray_scene);
    scene_destroy(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_hit_is_described),
        cmocka_unit_test(test_placement_and_visibility),
        cmocka_unit_test(test_holes_of_masks),
        cmocka_unit_test(test_occlusion_asks_what_lets_light_pass),
        cmocka_unit_test(test_batches_of_any_size_find_what_single_rays_do),
        cmocka_unit_test(test_arguments_that_are_not_finite),
        cmocka_unit_test(test_empty_scene),
        cmocka_unit_test(test_cornell_box),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
