#include "support_gi_scenes.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

#include "renderer/import/builtin/builtin.h"
#include "renderer/import/builtin/mesh_builder.h"

#define GRAY(value) ((const float[3]){(value), (value), (value)})

void gi_turn(float angle_rad, float out_rotation[4])
{
    glm_quatv(out_rotation, angle_rad, (vec3){2.0f, 3.0f, 1.0f});
}

static void turn_vector(float angle_rad, const float vector[3], float out_vector[3])
{
    float rotation[4];
    gi_turn(angle_rad, rotation);
    glm_quat_rotatev(rotation, (float *)vector, out_vector);
}

static struct scene *create(const char *name)
{
    struct scene *scene = scene_create(name);
    assert_non_null(scene);
    return scene;
}

static uint32_t add_matte(struct scene *scene, const float reflectance[3], float emission)
{
    uint32_t material = builtin_add_matte(scene, "matte", reflectance);
    assert_int_not_equal(material, SCENE_NONE);
    scene->materials[material].emissive_strength = emission > 0.0f ? emission : 1.0f;
    for (int c = 0; c < 3; c++)
        scene->materials[material].emissive[c] = emission > 0.0f ? 1.0f : 0.0f;
    return material;
}

// A node, rotated about the origin, that carries everything in the builder.
static void add_object(struct scene *scene, struct mesh_builder *builder, uint32_t material,
                       float turn_rad)
{
    uint32_t mesh = mesh_builder_commit_mesh(builder, scene, "object", material);
    assert_int_not_equal(mesh, SCENE_NONE);
    uint32_t node = builtin_add_mesh_node(scene, "object", mesh);
    assert_int_not_equal(node, SCENE_NONE);
    gi_turn(turn_rad, scene->nodes[node].rotation);
}

static void add_light(struct scene *scene, const float position[3], float intensity_cd)
{
    struct scene_light light;
    scene_light_init(&light, SCENE_LIGHT_POINT, "lamp");
    light.intensity = intensity_cd;
    uint32_t id = scene_add_light(scene, &light, position, (float[3]){0.0f, -1.0f, 0.0f});
    assert_int_not_equal(id, SCENE_NONE);
}

static void add_camera(struct scene *scene, const float eye[3], const float target[3],
                       float fov_y_rad)
{
    uint32_t camera =
        scene_add_camera(scene, "camera", eye, target, (float[3]){0.0f, 1.0f, 0.0f}, fov_y_rad);
    assert_int_not_equal(camera, SCENE_NONE);
    scene_update_world_transforms(scene);
}

// The faces of a box, seen from inside, each cut into divisions x divisions quads.
static void add_inside(struct mesh_builder *builder, const float low[3], const float high[3],
                       unsigned faces, uint32_t divisions)
{
    for (int face = 0; face < 6; face++) {
        if (!(faces & (1u << face)))
            continue;
        int axis = face / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
        for (uint32_t i = 0; i < divisions * divisions; i++) {
            float corners[4][3];
            for (uint32_t corner = 0; corner < 4; corner++) {
                // Counter-clockwise about the axis, hence seen from its positive side, is inside
                // for the low face.
                uint32_t k = face % 2 ? 3 - corner : corner;
                float s = (float)(i % divisions + (k == 1 || k == 2)) / (float)divisions;
                float t = (float)(i / divisions + (k >= 2)) / (float)divisions;
                corners[corner][axis] = face % 2 ? high[axis] : low[axis];
                corners[corner][u] = low[u] + s * (high[u] - low[u]);
                corners[corner][v] = low[v] + t * (high[v] - low[v]);
            }
            mesh_builder_add_quad(builder, corners);
        }
    }
}

struct scene *gi_box_scene(const struct gi_box_params *params)
{
    struct scene *scene = create("box");
    float e = params->half_edge_m;
    uint32_t wall = add_matte(scene, GRAY(params->albedo), params->emission);
    struct mesh_builder builder;
    mesh_builder_init(&builder);
    add_inside(&builder, GRAY(-e), GRAY(e), BOX_ALL, params->divisions);
    add_object(scene, &builder, wall, params->turn_rad);
    if (params->intensity_cd > 0.0f)
        add_light(scene, GRAY(0.0f), params->intensity_cd);
    float eye[3], target[3];
    turn_vector(params->turn_rad, (const float[3]){-0.7f * e, -0.3f * e, 0.62f * e}, eye);
    turn_vector(params->turn_rad, (const float[3]){0.6f * e, 0.2f * e, -0.5f * e}, target);
    add_camera(scene, eye, target, 1.6f);
    return scene;
}

void gi_box_look_at_wall(float turn_rad, uint32_t wall, struct view_camera *out_camera)
{
    float normal[3] = {0}, up[3] = {0};
    normal[wall / 2] = wall % 2 ? -1.0f : 1.0f;
    up[(wall / 2 + 1) % 3] = 1.0f;
    *out_camera = (struct view_camera){.fov_y_rad = 0.5f * (float)M_PI};
    turn_vector(turn_rad, normal, out_camera->target);
    turn_vector(turn_rad, up, out_camera->up);
}

struct scene *gi_corridor_scene(void)
{
    // One arm along X (the light's), one along Z (the camera's); 1.3 m wide, 2.1 m high.
    struct scene *scene = create("corridor");
    uint32_t plaster = add_matte(scene, (const float[3]){0.62f, 0.58f, 0.51f}, 0.0f);
    uint32_t brick = add_matte(scene, (const float[3]){0.55f, 0.21f, 0.14f}, 0.0f);
    uint32_t carpet = add_matte(scene, (const float[3]){0.12f, 0.24f, 0.38f}, 0.0f);
    struct mesh_builder builder;
    mesh_builder_init(&builder);
    const float low[3] = {-0.65f, 0.0f, -0.65f}, bend[3] = {0.65f, 2.1f, 0.65f};
    const float right[3] = {4.1f, 2.1f, 0.65f}, front[3] = {0.65f, 2.1f, 5.2f};
    const float right_low[3] = {0.65f, 0.0f, -0.65f}, front_low[3] = {-0.65f, 0.0f, 0.65f};
    add_inside(&builder, low, bend, BOX_TOP | BOX_BACK, 1);
    add_inside(&builder, right_low, right, BOX_TOP | BOX_BACK | BOX_FRONT, 1);
    add_inside(&builder, front_low, front, BOX_TOP | BOX_RIGHT | BOX_FRONT, 1);
    add_object(scene, &builder, plaster, 0.0f);
    add_inside(&builder, low, bend, BOX_LEFT, 1);
    add_inside(&builder, front_low, front, BOX_LEFT, 1);
    add_inside(&builder, right_low, right, BOX_RIGHT, 1);
    add_object(scene, &builder, brick, 0.0f);
    add_inside(&builder, low, bend, BOX_BOTTOM, 1);
    add_inside(&builder, right_low, right, BOX_BOTTOM, 1);
    add_inside(&builder, front_low, front, BOX_BOTTOM, 1);
    add_object(scene, &builder, carpet, 0.0f);
    add_light(scene, (const float[3]){3.1f, 1.6f, 0.1f}, 45.0f);
    add_camera(scene, (const float[3]){0.2f, 1.5f, 4.7f}, (const float[3]){-0.1f, 0.9f, 0.0f},
               0.9f);
    return scene;
}

struct scene *gi_courtyard_scene(void)
{
    struct scene *scene = create("courtyard");
    static const float colors[6][3] = {{0.7f, 0.2f, 0.1f},    {0.15f, 0.4f, 0.65f},
                                       {0.5f, 0.48f, 0.42f},  {0},
                                       {0.75f, 0.68f, 0.25f}, {0.3f, 0.55f, 0.2f}};
    const float low[3] = {-1.9f, 0.0f, -1.6f}, high[3] = {1.9f, 2.7f, 1.6f};
    struct mesh_builder builder;
    mesh_builder_init(&builder);
    for (uint32_t face = 0; face < 6; face++) {
        if (1u << face == BOX_TOP)
            continue;
        add_inside(&builder, low, high, 1u << face, 1);
        add_object(scene, &builder, add_matte(scene, colors[face], 0.0f), 0.0f);
    }
    mesh_builder_add_box(&builder, (const float[3]){-0.2f, 0.0f, -0.9f},
                         (const float[3]){0.45f, 1.7f, -0.3f}, BOX_ALL & ~(unsigned)BOX_BOTTOM);
    add_object(scene, &builder, add_matte(scene, GRAY(0.6f), 0.0f), 0.0f);
    scene->environment = (struct scene_environment){
        .type = SCENE_ENVIRONMENT_CONSTANT, .intensity = 3.0f, .color = {0.8f, 0.95f, 1.2f}};
    add_camera(scene, (const float[3]){1.1f, 1.9f, 1.45f}, (const float[3]){-0.3f, 0.7f, -0.8f},
               1.2f);
    return scene;
}

struct scene *gi_glowing_ball_scene(void)
{
    struct scene *scene = create("glowing ball");
    struct mesh_builder builder;
    mesh_builder_init(&builder);
    const float low[3] = {-1.4f, -1.1f, -1.7f}, high[3] = {1.4f, 1.1f, 1.7f};
    add_inside(&builder, low, high, BOX_ALL & ~(unsigned)BOX_LEFT, 1);
    add_object(scene, &builder, add_matte(scene, GRAY(0.55f), 0.0f), 0.0f);
    add_inside(&builder, low, high, BOX_LEFT, 1);
    add_object(scene, &builder, add_matte(scene, (const float[3]){0.6f, 0.15f, 0.1f}, 0.0f), 0.0f);
    mesh_builder_add_sphere(&builder, (const float[3]){-0.3f, 0.2f, -0.5f}, 0.3f, 24, 16);
    add_object(scene, &builder, add_matte(scene, GRAY(0.3f), 6.0f), 0.0f);
    add_camera(scene, (const float[3]){0.5f, 0.1f, 1.6f}, (const float[3]){-0.2f, -0.1f, -1.0f},
               1.1f);
    return scene;
}

struct scene *gi_metal_floor_scene(void)
{
    struct scene *scene = create("metal floor");
    const float low[3] = {-1.5f, 0.0f, -1.5f}, high[3] = {1.5f, 2.2f, 1.5f};
    struct mesh_builder builder;
    mesh_builder_init(&builder);
    add_inside(&builder, low, high, BOX_TOP | BOX_RIGHT | BOX_FRONT, 1);
    add_object(scene, &builder, add_matte(scene, GRAY(0.6f), 0.0f), 0.0f);
    add_inside(&builder, low, high, BOX_LEFT, 1);
    add_object(scene, &builder, add_matte(scene, (const float[3]){0.65f, 0.12f, 0.1f}, 0.0f), 0.0f);
    add_inside(&builder, low, high, BOX_BACK, 1);
    add_object(scene, &builder, add_matte(scene, (const float[3]){0.2f, 0.35f, 0.7f}, 0.0f), 0.0f);
    uint32_t metal = add_matte(scene, (const float[3]){0.85f, 0.8f, 0.7f}, 0.0f);
    scene->materials[metal].metallic = 1.0f;
    scene->materials[metal].roughness = 0.4f;
    add_inside(&builder, low, high, BOX_BOTTOM, 1);
    add_object(scene, &builder, metal, 0.0f);
    const float key_light[4][3] = {
        {-0.2f, 2.1f, -0.5f}, {0.4f, 2.1f, -0.5f}, {0.4f, 2.1f, 0.1f}, {-0.2f, 2.1f, 0.1f}};
    mesh_builder_add_quad(&builder, key_light);
    add_object(scene, &builder, add_matte(scene, GRAY(0.5f), 8.0f), 0.0f);
    add_camera(scene, (const float[3]){0.3f, 1.4f, 1.4f}, (const float[3]){-0.1f, 0.5f, -0.5f},
               1.0f);
    return scene;
}

struct scene *gi_table_scene(void)
{
    struct scene *scene = create("table");
    const float low[3] = {-1.5f, 0.0f, -1.5f}, high[3] = {1.5f, 2.2f, 1.5f};
    struct mesh_builder builder;
    mesh_builder_init(&builder);
    add_inside(&builder, low, high, BOX_TOP | BOX_RIGHT | BOX_FRONT | BOX_BOTTOM, 1);
    add_object(scene, &builder, add_matte(scene, GRAY(0.6f), 0.0f), 0.0f);
    add_inside(&builder, low, high, BOX_LEFT, 1);
    add_object(scene, &builder, add_matte(scene, (const float[3]){0.65f, 0.12f, 0.1f}, 0.0f), 0.0f);
    uint32_t mirror = add_matte(scene, (const float[3]){0.9f, 0.9f, 0.85f}, 0.0f);
    scene->materials[mirror].metallic = 1.0f;
    scene->materials[mirror].roughness = 0.02f;
    add_inside(&builder, low, high, BOX_BACK, 1);
    add_object(scene, &builder, mirror, 0.0f);
    mesh_builder_add_box(&builder, (const float[3]){-0.7f, 0.14f, -0.9f},
                         (const float[3]){0.5f, 0.18f, 0.1f}, BOX_ALL);
    add_object(scene, &builder, add_matte(scene, (const float[3]){0.2f, 0.35f, 0.7f}, 0.0f), 0.0f);
    add_light(scene, (const float[3]){0.6f, 1.9f, 0.4f}, 10.0f);
    add_camera(scene, (const float[3]){0.5f, 0.7f, 1.4f}, (const float[3]){-0.1f, 0.3f, -0.5f},
               1.0f);
    return scene;
}

struct scene *gi_penumbra_scene(bool sheet, float radius_m)
{
    struct scene *scene = create("penumbra");
    uint32_t plaster = add_matte(scene, GRAY(0.7f), 0.0f);
    struct mesh_builder builder;
    mesh_builder_init(&builder);
    mesh_builder_add_box(&builder, (const float[3]){-2.0f, -0.1f, -2.0f},
                         (const float[3]){2.0f, 0.0f, 2.0f}, BOX_ALL);
    if (sheet)
        mesh_builder_add_box(&builder, (const float[3]){-2.0f, 1.0f, -2.0f},
                             (const float[3]){0.0f, 1.002f, 2.0f}, BOX_ALL);
    add_object(scene, &builder, plaster, 0.0f);
    add_light(scene, (const float[3]){0.0f, 2.0f, 0.0f}, 10.0f);
    scene->lights[0].radius_m = radius_m;
    uint32_t camera =
        scene_add_camera(scene, "camera", (const float[3]){0.0f, 0.8f, 0.0f},
                         (const float[3]){0.0f, 0.0f, 0.0f}, (float[3]){0.0f, 0.0f, -1.0f}, 1.0f);
    assert_int_not_equal(camera, SCENE_NONE);
    return scene;
}

static void rooms_wall(const struct gi_rooms_params *params, float out_low[3], float out_high[3])
{
    float e = GI_ROOMS_HALF_EXTENT_M;
    memcpy(out_low, (const float[3]){params->offset_m - 0.5f * params->wall_m, -e, -e},
           3 * sizeof(float));
    memcpy(out_high, (const float[3]){params->offset_m + 0.5f * params->wall_m, e, e},
           3 * sizeof(float));
}

struct scene *gi_rooms_scene(const struct gi_rooms_params *params)
{
    struct scene *scene = create("two rooms");
    uint32_t plaster = add_matte(scene, GRAY(0.7f), 0.0f);
    float e = GI_ROOMS_HALF_EXTENT_M, low[3], high[3];
    rooms_wall(params, low, high);
    struct mesh_builder builder;
    mesh_builder_init(&builder);
    // The rooms' faces end at the wall, so that none passes through it.
    add_inside(&builder, GRAY(-e), (const float[3]){low[0], e, e}, BOX_ALL, 1);
    add_inside(&builder, (const float[3]){high[0], -e, -e}, GRAY(e), BOX_ALL, 1);
    add_object(scene, &builder, plaster, params->turn_rad);
    float key_light[3];
    turn_vector(params->turn_rad, (const float[3]){-1.0f, 0.3f, 0.2f}, key_light);
    add_light(scene, key_light, 10.0f);
    scene_update_world_transforms(scene);
    return scene;
}

void gi_rooms_look(const struct gi_rooms_params *params, uint32_t room,
                   struct view_camera *out_camera)
{
    // From the far corner towards the wall between the rooms.
    float side = room == 0 ? -1.0f : 1.0f, e = GI_ROOMS_HALF_EXTENT_M;
    const float eye[3] = {side * 0.9f * e, 0.7f * e, 0.8f * e};
    const float target[3] = {0.0f, -0.3f * e, -0.2f * e};
    *out_camera = (struct view_camera){.fov_y_rad = 1.7f};
    turn_vector(params->turn_rad, eye, out_camera->eye);
    turn_vector(params->turn_rad, target, out_camera->target);
    turn_vector(params->turn_rad, (const float[3]){0.0f, 1.0f, 0.0f}, out_camera->up);
}

void gi_scene_camera(const struct scene *scene, struct view_camera *out_camera)
{
    scene_get_camera_placement(scene, 0, out_camera->eye, out_camera->target, out_camera->up);
    out_camera->fov_y_rad = scene->cameras[0].fov_y_rad;
}

double gi_scene_extent(const struct scene *scene)
{
    double low[3], high[3], extent = 0.0;
    assert_true(scene_bounds(scene, low, high));
    for (int axis = 0; axis < 3; axis++)
        extent = fmax(extent, high[axis] - low[axis]);
    return extent;
}
