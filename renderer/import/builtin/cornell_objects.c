// Four objects in the Cornell box, of polished metal, clear glass, glossy lacquer and rough stone,
// and a dim warm light to move; or all four of one kind, to isolate errors of one kind of light
// transport.
#include <math.h>

#include "renderer/import/builtin/builtin.h"
#include "renderer/import/builtin/builtin_shapes.h"

#define TEAPOT_SCALE      0.038f // 248 mm from handle to spout
#define GLASS_RADIUS_M    0.08f
#define TORUS_RING_M      0.05f
#define TORUS_TUBE_M      0.022f
#define STONE_HALF_EDGE_M 0.07f

#define GLOSSY_ROUGHNESS 0.15f
#define GLOW_RADIANCE    3.0f // cd/m^2

// Material of the four objects.
enum object_kind { KIND_OWN, KIND_DIFFUSE, KIND_GLOSSY, KIND_GLASS, KIND_EMISSIVE };

struct object {
    const char *name;
    struct scene_material material;
    float origin[2]; // x and z of the shape's origin, metres; it stands on the floor
    float turn_rad;
    void (*add)(struct mesh_builder *builder);
};

static void add_teapot(struct mesh_builder *builder)
{
    mesh_builder_add_teapot(builder, TEAPOT_SCALE, 14);
}

static void add_glass(struct mesh_builder *builder)
{
    mesh_builder_add_sphere(builder, (float[3]){0, 0, 0}, GLASS_RADIUS_M, 64, 32);
}

static void add_torus(struct mesh_builder *builder)
{
    mesh_builder_add_torus(builder, TORUS_RING_M, TORUS_TUBE_M, 64, 28);
}

static double signed_power(double base, double exponent)
{
    return copysign(pow(fabs(base), exponent), base);
}

// A superellipsoid between cube and sphere, with shallow dents as of hewn stone.
static void stone_position(const void *context, double u, double v, double out_position[3])
{
    (void)context;
    const double squareness = 0.45;
    double turn = 2.0 * M_PI * (u - floor(u)), latitude = M_PI * (v - 0.5);
    double ring = v <= 0.0 || v >= 1.0 ? 0.0 : pow(cos(latitude), squareness);
    double x = ring * signed_power(sin(turn), squareness);
    double y = signed_power(sin(latitude), squareness);
    double z = ring * signed_power(cos(turn), squareness);
    double dents = sin(5.1 * x + 1.0) * sin(4.3 * y + 2.0) * sin(4.7 * z + 0.5) +
                   0.5 * sin(9.7 * x + 3.1 * y) * sin(8.3 * z + 2.9 * y + 1.7);
    double size = STONE_HALF_EDGE_M * (0.97 + 0.035 * dents);
    out_position[0] = size * x;
    out_position[1] = size * y;
    out_position[2] = size * z;
}

static void add_stone(struct mesh_builder *builder)
{
    struct surface_params params = {
        .position = stone_position,
        .columns = 96,
        .rows = 48,
        .texture_size = {0.4f, -0.2f},
    };
    mesh_builder_add_surface(builder, &params);
}

static void describe_objects(struct object objects[4])
{
    struct object *teapot = &objects[0], *glass = &objects[1];
    struct object *torus = &objects[2], *stone = &objects[3];
    *teapot = (struct object){"copper teapot", .origin = {-0.1f, -0.11f}, .turn_rad = -0.45f,
                              .add = add_teapot};
    *glass = (struct object){"glass ball", .origin = {0.125f, 0.115f}, .add = add_glass};
    *torus = (struct object){"lacquered ring", .origin = {-0.115f, 0.125f}, .add = add_torus};
    *stone = (struct object){"rough stone", .origin = {0.15f, -0.1f}, .turn_rad = 0.4f,
                             .add = add_stone};
    for (int i = 0; i < 4; i++)
        scene_material_init(&objects[i].material, objects[i].name);
    teapot->material.double_sided = true; // spout and lid gap are open
    teapot->material.roughness = 0.12f;
    glm_vec3_copy((vec3){0.955f, 0.638f, 0.538f}, teapot->material.base_color);
    glass->material.metallic = 0.0f;
    glass->material.roughness = 0.0f;
    glass->material.transmission = 1.0f;
    glass->material.thickness_m = 2.0f * GLASS_RADIUS_M;
    torus->material.metallic = 0.0f;
    torus->material.roughness = 0.15f;
    glm_vec3_copy((vec3){0.02f, 0.1f, 0.45f}, torus->material.base_color);
    stone->material.metallic = 0.0f;
    stone->material.roughness = 1.0f;
    glm_vec3_copy((vec3){0.55f, 0.47f, 0.36f}, stone->material.base_color);
}

// Changes an object's material to a kind; keeps the colour, except for glass.
static void dress(struct object *object, enum object_kind kind)
{
    struct scene_material *material = &object->material;
    if (kind == KIND_OWN)
        return;
    material->metallic = 0.0f;
    material->transmission = kind == KIND_GLASS ? 1.0f : 0.0f;
    // The pot is open: it has a thin wall.
    bool closed = !material->double_sided;
    material->thickness_m = kind == KIND_GLASS && closed ? 2.0f * GLASS_RADIUS_M : 0.0f;
    material->roughness = 1.0f;
    if (kind == KIND_GLOSSY)
        material->roughness = GLOSSY_ROUGHNESS;
    if (kind == KIND_GLASS) {
        material->roughness = 0.0f;
        glm_vec3_one(material->base_color);
    }
    if (kind == KIND_DIFFUSE)
        material->ior = 1.0f;
    if (kind == KIND_EMISSIVE) {
        glm_vec3_copy(material->base_color, material->emissive);
        material->emissive_strength = GLOW_RADIANCE;
    }
}

// Only the objects emit light.
static void put_out_light(struct scene *scene)
{
    for (uint32_t i = 0; i < scene->material_count; i++)
        glm_vec3_zero(scene->materials[i].emissive);
}

static bool add_reading_light(struct scene *scene)
{
    struct scene_light light;
    scene_light_init(&light, SCENE_LIGHT_POINT, "reading light");
    light.intensity = 0.15f;
    glm_vec3_copy((vec3){1.0f, 0.72f, 0.42f}, light.color);
    return scene_add_light(scene, &light, (float[3]){0.02f, 0.3f, 0.16f}, (float[3]){0, -1, 0}) !=
           SCENE_NONE;
}

static bool add_object(struct scene *scene, const struct object *object)
{
    struct mesh_builder builder;
    mesh_builder_init(&builder);
    object->add(&builder);
    uint32_t material = scene_add_material(scene, &object->material);
    uint32_t mesh = mesh_builder_commit_mesh(&builder, scene, object->name, material);
    if (mesh == SCENE_NONE)
        return false;
    uint32_t node = builtin_add_mesh_node(scene, object->name, mesh);
    if (node == SCENE_NONE)
        return false;
    float *origin = scene->nodes[node].translation;
    origin[0] = object->origin[0];
    origin[1] = -scene->primitives[scene->meshes[mesh].primitive_first].bounds_min[1];
    origin[2] = object->origin[1];
    glm_quatv(scene->nodes[node].rotation, object->turn_rad, (vec3){0, 1, 0});
    return true;
}

static bool build(struct scene *scene, enum object_kind kind)
{
    struct object objects[4];
    describe_objects(objects);
    if (!builtin_add_cornell_room(scene))
        return false;
    if (kind == KIND_EMISSIVE)
        put_out_light(scene);
    for (int i = 0; i < 4; i++) {
        dress(&objects[i], kind);
        if (!add_object(scene, &objects[i]))
            return false;
    }
    return (kind == KIND_EMISSIVE || add_reading_light(scene)) &&
           scene_add_camera(scene, "close", (float[3]){0.0f, 0.24f, 0.75f},
                            (float[3]){0.0f, 0.1f, -0.03f}, (float[3]){0, 1, 0},
                            0.55f) != SCENE_NONE;
}

bool builtin_build_cornell_objects(struct scene *scene)
{
    return build(scene, KIND_OWN);
}

bool builtin_build_cornell_objects_diffuse(struct scene *scene)
{
    return build(scene, KIND_DIFFUSE);
}

bool builtin_build_cornell_objects_glossy(struct scene *scene)
{
    return build(scene, KIND_GLOSSY);
}

bool builtin_build_cornell_objects_glass(struct scene *scene)
{
    return build(scene, KIND_GLASS);
}

bool builtin_build_cornell_objects_emissive(struct scene *scene)
{
    return build(scene, KIND_EMISSIVE);
}
