#include "support_reference.h"

#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <cmocka.h>

#include <stdlib.h>
#include <string.h>

#include "renderer/path_tracer/snapshot.h"
#include "renderer/import/builtin/builtin.h"
#include "renderer/import/builtin/mesh_builder.h"

struct scene *support_scene_create(void)
{
    struct scene *scene = scene_create("test");
    assert_non_null(scene);
    return scene;
}

static uint32_t add_material(struct scene *scene, const struct scene_material *material)
{
    uint32_t id = scene_add_material(scene, material);
    assert_int_not_equal(id, SCENE_NONE);
    return id;
}

uint32_t support_add_matte(struct scene *scene, float reflectance)
{
    uint32_t id =
        builtin_add_matte(scene, "matte", (const float[3]){reflectance, reflectance, reflectance});
    assert_int_not_equal(id, SCENE_NONE);
    return id;
}

uint32_t support_add_emissive(struct scene *scene, float radiance)
{
    uint32_t id = support_add_matte(scene, 0.0f);
    for (int c = 0; c < 3; c++)
        scene->materials[id].emissive[c] = 1.0f;
    scene->materials[id].emissive_strength = radiance;
    return id;
}

uint32_t support_add_glass(struct scene *scene, float ior, float roughness, float thickness_m)
{
    struct scene_material glass;
    scene_material_init(&glass, "glass");
    glass.metallic = 0.0f;
    glass.ior = ior;
    glass.roughness = roughness;
    glass.transmission = 1.0f;
    glass.thickness_m = thickness_m;
    return add_material(scene, &glass);
}

static void add_mesh_node(struct scene *scene, uint32_t mesh)
{
    assert_int_not_equal(mesh, SCENE_NONE);
    assert_int_not_equal(builtin_add_mesh_node(scene, "part", mesh), SCENE_NONE);
    scene_update_world_transforms(scene);
}

void support_add_quad(struct scene *scene, uint32_t material, const float corners[4][3])
{
    uint32_t mesh = scene_add_mesh(scene, "quad");
    assert_true(builtin_add_quad(scene, corners, material));
    add_mesh_node(scene, mesh);
}

void support_add_floor(struct scene *scene, uint32_t material, const float low[2],
                       const float high[2], float z, bool down)
{
    const float up_corners[4][3] = {
        {low[0], low[1], z}, {high[0], low[1], z}, {high[0], high[1], z}, {low[0], high[1], z}};
    const float down_corners[4][3] = {
        {low[0], low[1], z}, {low[0], high[1], z}, {high[0], high[1], z}, {high[0], low[1], z}};
    support_add_quad(scene, material, down ? down_corners : up_corners);
}

void support_add_box(struct scene *scene, uint32_t material, const float low[3],
                     const float high[3])
{
    struct mesh_builder builder;
    mesh_builder_init(&builder);
    mesh_builder_add_box(&builder, low, high, BOX_ALL);
    add_mesh_node(scene, mesh_builder_commit_mesh(&builder, scene, "box", material));
}

struct reference_params support_narrow_view(const float eye[3], const float target[3])
{
    struct reference_params params = {
        .camera = {.up = {0.0f, 1.0f, 0.0f}, .fov_y_rad = 0.002f},
        .width = 16,
        .height = 16,
        .max_bounces = REFERENCE_UNLIMITED,
        .seed = 7,
        .threads = 2,
    };
    memcpy(params.camera.eye, eye, sizeof(params.camera.eye));
    memcpy(params.camera.target, target, sizeof(params.camera.target));
    return params;
}

struct reference *support_reference_create(const struct scene *scene,
                                           const struct reference_params *params)
{
    struct error error = {""};
    struct reference_params filled = *params;
    filled.scene = snapshot_create(scene, false, &error);
    assert_non_null(filled.scene);
    struct reference *reference = reference_create(&filled, &error);
    assert_non_null(reference);
    snapshot_release(&filled.scene);
    return reference;
}

void support_reference_mean(const struct scene *scene, const struct reference_params *params,
                            uint32_t samples, uint32_t layers, double out_mean[3])
{
    struct reference *reference = support_reference_create(scene, params);
    size_t pixels = (size_t)params->width * params->height;
    float *rgba = malloc(pixels * 4 * sizeof(float));
    assert_non_null(rgba);
    assert_true(reference_render(reference, samples));
    reference_get_picture(reference, layers, rgba);
    for (size_t c = 0; c < 3; c++) {
        out_mean[c] = 0.0;
        for (size_t i = 0; i < pixels; i++)
            out_mean[c] += rgba[4 * i + c] / (double)pixels;
    }
    free(rgba);
    reference_destroy(&reference);
}
