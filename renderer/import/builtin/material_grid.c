// Rows of spheres, a material per row, with roughness rising from left to right; lit by the sun, a
// rectangular light and a sky.
#include <stdio.h>

#include "renderer/import/builtin/builtin.h"
#include "renderer/import/builtin/mesh_builder.h"

#define COLUMNS         8
#define SPHERE_RADIUS_M 0.4f
#define SPACING_M       1.0f
#define FLOOR_TILES     24 // along each edge
#define FLOOR_TILE_M    0.5f

static const struct row {
    const char *name;
    float metallic;
    float color[3];
} rows[] = {
    {"gold, metallic 1", 1.0f, {1.0f, 0.766f, 0.336f}},
    {"gold, metallic 0.5", 0.5f, {1.0f, 0.766f, 0.336f}},
    {"white", 0.0f, {0.8f, 0.8f, 0.8f}},
    {"red", 0.0f, {0.6f, 0.03f, 0.03f}},
    {"green", 0.0f, {0.05f, 0.35f, 0.08f}},
    {"blue", 0.0f, {0.03f, 0.08f, 0.5f}},
};

#define ROWS (sizeof(rows) / sizeof(rows[0]))

static bool add_spheres(struct scene *scene)
{
    struct mesh_builder builder;
    mesh_builder_init(&builder);
    for (uint32_t i = 0; i < ROWS * COLUMNS; i++) {
        const struct row *row = &rows[i / COLUMNS];
        uint32_t column = i % COLUMNS;
        float roughness = (float)column / (COLUMNS - 1);
        char name[64];
        snprintf(name, sizeof(name), "%s, roughness %.2f", row->name, roughness);
        struct scene_material material;
        scene_material_init(&material, name);
        glm_vec3_copy((float *)row->color, material.base_color);
        material.metallic = row->metallic;
        material.roughness = roughness;
        mesh_builder_add_sphere(&builder, (float[3]){0, 0, 0}, SPHERE_RADIUS_M, 40, 20);
        uint32_t mesh =
            mesh_builder_commit_mesh(&builder, scene, name, scene_add_material(scene, &material));
        uint32_t node = mesh == SCENE_NONE ? SCENE_NONE : builtin_add_mesh_node(scene, name, mesh);
        if (node == SCENE_NONE)
            return false;
        float *origin = scene->nodes[node].translation;
        origin[0] = ((float)column - 0.5f * (COLUMNS - 1)) * SPACING_M;
        origin[1] = SPHERE_RADIUS_M + 0.15f + (float)(ROWS - 1 - i / COLUMNS) * SPACING_M;
    }
    return true;
}

// Light and dark tiles, a primitive each, on one slab.
static bool add_floor(struct scene *scene)
{
    static const float reflectances[2][3] = {{0.55f, 0.55f, 0.55f}, {0.12f, 0.12f, 0.13f}};
    uint32_t mesh = scene_add_mesh(scene, "floor");
    if (mesh == SCENE_NONE)
        return false;
    const float edge = 0.5f * FLOOR_TILES * FLOOR_TILE_M;
    struct mesh_builder builder;
    mesh_builder_init(&builder);
    for (int dark = 0; dark < 2; dark++) {
        for (int i = 0; i < FLOOR_TILES * FLOOR_TILES; i++) {
            int column = i % FLOOR_TILES, row = i / FLOOR_TILES;
            if (((column + row) & 1) != dark)
                continue;
            float x = (float)column * FLOOR_TILE_M - edge, z = (float)row * FLOOR_TILE_M - edge;
            mesh_builder_add_box(&builder, (float[3]){x, -0.2f, z},
                                 (float[3]){x + FLOOR_TILE_M, 0.0f, z + FLOOR_TILE_M}, BOX_TOP);
        }
        if (!dark)
            mesh_builder_add_box(&builder, (float[3]){-edge, -0.2f, -edge},
                                 (float[3]){edge, 0.0f, edge}, BOX_ALL & ~BOX_TOP);
        uint32_t material =
            builtin_add_matte(scene, dark ? "dark tiles" : "light tiles", reflectances[dark]);
        if (!mesh_builder_commit(&builder, scene, material))
            return false;
    }
    return builtin_add_mesh_node(scene, "floor", mesh) != SCENE_NONE;
}

static bool add_lighting(struct scene *scene)
{
    struct scene_light sun;
    scene_light_init(&sun, SCENE_LIGHT_DIRECTIONAL, "sun");
    sun.intensity = 6.0f;
    glm_vec3_copy((vec3){1.0f, 0.96f, 0.9f}, sun.color);
    struct scene_material light;
    scene_material_init(&light, "lamp");
    glm_vec4_zero(light.base_color);
    light.base_color[3] = 1.0f;
    light.metallic = 0.0f;
    light.ior = 1.0f;
    light.emissive_strength = 25.0f;
    glm_vec3_one(light.emissive);
    static const float corners[4][3] = {
        {-8.5f, 8.0f, 5.0f}, {-8.5f, 6.0f, 7.0f}, {-5.5f, 6.0f, 8.0f}, {-5.5f, 8.0f, 6.0f}};
    uint32_t mesh = scene_add_mesh(scene, "lamp");
    uint32_t material = scene_add_material(scene, &light);
    struct scene_environment sky = {
        .type = SCENE_ENVIRONMENT_GRADIENT,
        .intensity = 1.0f,
        .color = {0.25f, 0.4f, 0.75f},
        .horizon_color = {0.75f, 0.82f, 0.9f},
        .ground_color = {0.2f, 0.18f, 0.16f},
    };
    scene_set_environment(scene, &sky);
    return mesh != SCENE_NONE && material != SCENE_NONE &&
           builtin_add_quad(scene, corners, material) &&
           builtin_add_mesh_node(scene, "lamp", mesh) != SCENE_NONE &&
           scene_add_light(scene, &sun, (float[3]){6, 8, 6}, (float[3]){-0.6f, -0.9f, -0.8f}) !=
               SCENE_NONE;
}

bool builtin_build_material_grid(struct scene *scene)
{
    return add_spheres(scene) && add_floor(scene) && add_lighting(scene) &&
           scene_add_camera(scene, "whole grid", (float[3]){0.0f, 3.4f, 11.0f},
                            (float[3]){0.0f, 2.85f, 0.0f}, (float[3]){0, 1, 0},
                            0.62f) != SCENE_NONE;
}
