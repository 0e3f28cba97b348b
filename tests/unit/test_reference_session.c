// Proves how a reference works rather than what it shows: the same bits whatever the threads and
// interruptions, stopping, images per bounce that sum up, an estimate of noise that is right, and
// snapshots that outlive changes of the document.
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "renderer/import/scene_load.h"
#include "support_reference.h"

#define WIDTH  41u
#define HEIGHT 27u
#define FLOATS ((size_t)WIDTH * HEIGHT * 4)

struct fixture {
    struct scene *scene;
    struct reference_params params;
    float *pictures[2];
};

static int set_up(void **state)
{
    struct fixture *fixture = calloc(1, sizeof(*fixture));
    struct error error = {""};
    assert_non_null(fixture);
    fixture->scene = scene_load("builtin:cornell-objects", &error);
    assert_non_null(fixture->scene);
    fixture->params = support_narrow_view((float[3]){0}, (float[3]){0, 0, 1});
    struct view_camera *camera = &fixture->params.camera;
    scene_get_camera_placement(fixture->scene, 0, camera->eye, camera->target, camera->up);
    camera->fov_y_rad = fixture->scene->cameras[0].fov_y_rad;
    fixture->params.width = WIDTH;
    fixture->params.height = HEIGHT;
    for (int i = 0; i < 2; i++) {
        fixture->pictures[i] = malloc(FLOATS * sizeof(float));
        assert_non_null(fixture->pictures[i]);
    }
    *state = fixture;
    return 0;
}

static int tear_down(void **state)
{
    struct fixture *fixture = *state;
    if (fixture->scene)
        scene_destroy(&fixture->scene);
    free(fixture->pictures[0]);
    free(fixture->pictures[1]);
    free(fixture);
    return 0;
}

static bool same_pictures(const struct fixture *fixture)
{
    return memcmp(fixture->pictures[0], fixture->pictures[1], FLOATS * sizeof(float)) == 0;
}

static void render(const struct fixture *fixture, const struct reference_params *params,
                   uint32_t samples, uint32_t layers, float *out_picture)
{
    struct reference *reference = support_reference_create(fixture->scene, params);
    assert_true(reference_render(reference, samples));
    reference_get_picture(reference, layers, out_picture);
    reference_destroy(&reference);
}

static void test_threads_do_not_matter(void **state)
{
    struct fixture *fixture = *state;
    struct reference_params params = fixture->params;
    params.threads = 1;
    render(fixture, &params, 9, REFERENCE_ALL_LAYERS, fixture->pictures[0]);
    static const uint32_t threads[] = {2, 3, 7};
    for (int i = 0; i < 3; i++) {
        params.threads = threads[i];
        params.low_priority = i == 2;
        render(fixture, &params, 9, REFERENCE_ALL_LAYERS, fixture->pictures[1]);
        assert_true(same_pictures(fixture));
    }
    params.seed++;
    render(fixture, &params, 9, REFERENCE_ALL_LAYERS, fixture->pictures[1]);
    assert_false(same_pictures(fixture));
}

static void test_interruptions_do_not_matter(void **state)
{
    struct fixture *fixture = *state;
    render(fixture, &fixture->params, 40, REFERENCE_ALL_LAYERS, fixture->pictures[0]);
    struct reference *reference = support_reference_create(fixture->scene, &fixture->params);
    assert_true(reference_render(reference, 3));
    struct reference_progress progress;
    for (int i = 0; i < 20; i++) {
        reference_start(reference, 40);
        reference_wait(reference, 0.002);
        reference_stop(reference);
        reference_get_progress(reference, &progress);
        assert_true(progress.samples >= 3 && progress.samples <= 40);
    }
    reference_start(reference, 40);
    assert_true(reference_wait(reference, 60.0));
    reference_get_progress(reference, &progress);
    assert_int_equal(progress.samples, 40);
    assert_true(progress.nearest_rays > 40u * WIDTH * HEIGHT);
    reference_get_picture(reference, REFERENCE_ALL_LAYERS, fixture->pictures[1]);
    assert_true(same_pictures(fixture));
    reference_destroy(&reference);
}

static void test_stopping_keeps_the_picture(void **state)
{
    struct fixture *fixture = *state;
    struct reference *reference = support_reference_create(fixture->scene, &fixture->params);
    reference_start(reference, REFERENCE_MAX_SAMPLES);
    assert_false(reference_wait(reference, 0.05));
    reference_stop(reference);
    struct reference_progress first, second;
    reference_get_progress(reference, &first);
    reference_get_picture(reference, REFERENCE_ALL_LAYERS, fixture->pictures[0]);
    usleep(20000);
    reference_get_progress(reference, &second);
    reference_get_picture(reference, REFERENCE_ALL_LAYERS, fixture->pictures[1]);
    assert_true(first.nearest_rays == second.nearest_rays);
    assert_true(same_pictures(fixture));
    // Workers also stop when told to while they trace.
    reference_start(reference, REFERENCE_MAX_SAMPLES);
    reference_destroy(&reference);
    assert_null(reference);
}

static void test_layers_sum_up(void **state)
{
    struct fixture *fixture = *state;
    struct reference_params params = fixture->params;
    params.bounce_pictures = 4;
    struct reference *reference = support_reference_create(fixture->scene, &params);
    assert_true(reference_render(reference, 16));
    float *sum = calloc(FLOATS, sizeof(float));
    assert_non_null(sum);
    double means[REFERENCE_MAX_LAYERS] = {0};
    uint32_t layers = reference_layer_count(&params);
    assert_int_equal(layers, REFERENCE_FIRST_BOUNCE + 4);
    for (uint32_t layer = 0; layer < layers; layer++) {
        reference_get_picture(reference, REFERENCE_LAYER(layer), fixture->pictures[0]);
        for (size_t i = 0; i < FLOATS; i++) {
            sum[i] += fixture->pictures[0][i];
            means[layer] += i % 4 == 0 ? (double)fixture->pictures[0][i] : 0.0;
        }
        print_message("  layer %u: mean red %.5f\n", layer, means[layer] / (WIDTH * HEIGHT));
    }
    reference_get_picture(reference, REFERENCE_ALL_LAYERS, fixture->pictures[0]);
    for (size_t i = 0; i < FLOATS; i++)
        if (i % 4 < 3)
            assert_true(fabsf(sum[i] - fixture->pictures[0][i]) <= 1e-5f * (1.0f + sum[i]));
    free(sum);
    // There is no sky here; every further bounce is darker.
    assert_true(means[REFERENCE_EMISSION] > 0.0 && means[REFERENCE_SKY] == 0.0);
    for (uint32_t layer = REFERENCE_FIRST_BOUNCE; layer + 2 < layers; layer++)
        assert_true(means[layer] > means[layer + 1] && means[layer + 1] > 0.0);
    reference_destroy(&reference);
    params.max_bounces = 0;
    render(fixture, &params, 16, REFERENCE_INDIRECT_LAYERS, fixture->pictures[1]);
    for (size_t i = 0; i < FLOATS; i++)
        assert_true(fixture->pictures[1][i] == (i % 4 == 3 ? 1.0f : 0.0f));
}

// Fewer bounces are the same without the rest, bit by bit where no body refracts.
static void test_fewer_bounces_are_a_part(void **state)
{
    struct fixture *fixture = *state;
    struct reference_params params = fixture->params;
    for (uint32_t i = 0; i < fixture->scene->material_count; i++)
        fixture->scene->materials[i].transmission = 0.0f;
    params.bounce_pictures = 4;
    for (uint32_t bounces = 0; bounces < 3; bounces++) {
        params.max_bounces = REFERENCE_UNLIMITED;
        uint32_t first = REFERENCE_LAYER(REFERENCE_FIRST_BOUNCE + bounces) - 1u;
        render(fixture, &params, 16, first, fixture->pictures[0]);
        params.max_bounces = bounces;
        render(fixture, &params, 16, REFERENCE_ALL_LAYERS, fixture->pictures[1]);
        assert_true(same_pictures(fixture));
    }
}

// Compares the estimated noise with the difference of two independent images.
static void test_noise_is_estimated(void **state)
{
    struct fixture *fixture = *state;
    struct reference_params params = fixture->params;
    params.bounce_pictures = 1;
    params.max_bounces = 0; // no caustics, whose noise few samples cannot estimate
    double told = 0.0, squared = 0.0, mean = 0.0;
    for (int i = 0; i < 2; i++) {
        params.seed = 50 + (uint64_t)i;
        struct reference *reference = support_reference_create(fixture->scene, &params);
        struct reference_progress progress;
        assert_true(reference_render(reference, 1));
        reference_get_progress(reference, &progress);
        assert_true(isinf(progress.noise));
        assert_true(reference_render(reference, 63));
        reference_get_progress(reference, &progress);
        told += 0.5 * progress.noise;
        mean += 0.5 * progress.mean_luminance;
        reference_get_picture(reference, REFERENCE_ALL_LAYERS, fixture->pictures[i]);
        reference_destroy(&reference);
    }
    for (size_t i = 0; i < FLOATS; i += 4) {
        const float *a = fixture->pictures[0] + i, *b = fixture->pictures[1] + i;
        double difference = 0.2126 * ((double)a[0] - b[0]) + 0.7152 * ((double)a[1] - b[1]) +
                            0.0722 * ((double)a[2] - b[2]);
        squared += difference * difference / (WIDTH * HEIGHT);
    }
    double seen = sqrt(squared / 2.0) / mean;
    print_message("  noise told %.4f, seen %.4f\n", told, seen);
    assert_true(told > 0.6 * seen && told < 1.7 * seen);
}

static void test_snapshots_outlive_edits(void **state)
{
    struct fixture *fixture = *state;
    render(fixture, &fixture->params, 4, REFERENCE_ALL_LAYERS, fixture->pictures[0]);
    struct reference *reference = support_reference_create(fixture->scene, &fixture->params);
    struct scene_material black = fixture->scene->materials[0];
    memset(black.base_color, 0, sizeof(black.base_color));
    for (uint32_t i = 0; i < fixture->scene->material_count; i++)
        scene_set_material(fixture->scene, i, &black);
    for (uint32_t i = 0; i < fixture->scene->node_count; i++)
        scene_set_node_visible(fixture->scene, i, false);
    scene_destroy(&fixture->scene);
    assert_true(reference_render(reference, 4));
    reference_get_picture(reference, REFERENCE_ALL_LAYERS, fixture->pictures[1]);
    assert_true(same_pictures(fixture));
    reference_destroy(&reference);
}

// Far from the origin, where floats are a centimetre apart, everything is as near the origin.
static void test_far_from_the_origin(void **state)
{
    struct fixture *fixture = *state;
    render(fixture, &fixture->params, 16, REFERENCE_ALL_LAYERS, fixture->pictures[0]);
    struct reference_params params = fixture->params;
    const float far_m = 65536.0f; // a power of two: placements stay exact to 1/128 m
    for (uint32_t i = 0; i < fixture->scene->node_count; i++) {
        struct scene_node *node = &fixture->scene->nodes[i];
        float translation_of_node[3];
        memcpy(translation_of_node, node->translation, sizeof(translation_of_node));
        translation_of_node[0] += node->parent == SCENE_NONE ? far_m : 0.0f;
        scene_set_node_transform(fixture->scene, i, translation_of_node, node->rotation,
                                 node->scale);
    }
    params.camera.eye[0] += far_m;
    params.camera.target[0] += far_m;
    render(fixture, &params, 16, REFERENCE_ALL_LAYERS, fixture->pictures[1]);
    double means[2] = {0};
    for (size_t i = 0; i < FLOATS; i++)
        for (int j = 0; j < 2; j++)
            means[j] += i % 4 == 0 ? (double)fixture->pictures[j][i] : 0.0;
    support_assert_ratio(means[1], means[0], 0.03, "65 km off");
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(test_threads_do_not_matter, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_interruptions_do_not_matter, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_stopping_keeps_the_picture, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_layers_sum_up, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_fewer_bounces_are_a_part, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_noise_is_estimated, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_snapshots_outlive_edits, set_up, tear_down),
        cmocka_unit_test_setup_teardown(test_far_from_the_origin, set_up, tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
