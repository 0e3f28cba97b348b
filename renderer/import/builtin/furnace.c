// A white furnace: a closed box whose matte walls reflect half and emit 1 cd/m^2, around a matte
// sphere that reflects half and emits nothing. Without the sphere every wall converges to L = 1 + L
// / 2 = 2 cd/m^2; the sphere takes a few percent of that. The sphere sees only walls, so it must be
// a uniform disc of half their radiance. Any variation is an error of the renderer.
#include "renderer/import/builtin/builtin.h"
#include "renderer/import/builtin/mesh_builder.h"

#define BOX_HALF_EDGE_M 1.0f
#define SPHERE_RADIUS_M 0.4f

static const float reflectance[3] = {0.5f, 0.5f, 0.5f};

static bool add_walls(struct scene *scene, uint32_t material)
{
    const float e = BOX_HALF_EDGE_M;
    // Counter-clockwise seen from inside.
    const float walls[6][4][3] = {
        {{-e, -e, e}, {e, -e, e}, {e, -e, -e}, {-e, -e, -e}},
        {{-e, e, -e}, {e, e, -e}, {e, e, e}, {-e, e, e}},
        {{-e, -e, -e}, {e, -e, -e}, {e, e, -e}, {-e, e, -e}},
        {{e, -e, e}, {-e, -e, e}, {-e, e, e}, {e, e, e}},
        {{-e, -e, e}, {-e, -e, -e}, {-e, e, -e}, {-e, e, e}},
        {{e, -e, -e}, {e, -e, e}, {e, e, e}, {e, e, -e}},
    };
    uint32_t mesh = scene_add_mesh(scene, "walls");
    if (mesh == SCENE_NONE)
        return false;
    for (int i = 0; i < 6; i++)
        if (!builtin_add_quad(scene, walls[i], material))
            return false;
    return builtin_add_mesh_node(scene, "walls", mesh) != SCENE_NONE;
}

bool builtin_build_furnace(struct scene *scene)
{
    uint32_t wall = builtin_add_matte(scene, "glowing wall", reflectance);
    uint32_t ball = builtin_add_matte(scene, "ball", reflectance);
    if (wall == SCENE_NONE || ball == SCENE_NONE)
        return false;
    for (int c = 0; c < 3; c++)
        scene->materials[wall].emissive[c] = 1.0f;
    if (!add_walls(scene, wall))
        return false;
    struct mesh_builder builder;
    mesh_builder_init(&builder);
    mesh_builder_add_sphere(&builder, (float[3]){0, 0, 0}, SPHERE_RADIUS_M, 64, 32);
    uint32_t mesh = mesh_builder_commit_mesh(&builder, scene, "ball", ball);
    return mesh != SCENE_NONE && builtin_add_mesh_node(scene, "ball", mesh) != SCENE_NONE &&
           scene_add_camera(scene, "inside", (float[3]){0.0f, 0.1f, 0.97f}, (float[3]){0, 0, 0},
                            (float[3]){0, 1, 0}, 1.0f) != SCENE_NONE;
}
