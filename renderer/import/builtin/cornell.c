// The Cornell box, as measured and published by Cornell University's Program of Computer Graphics,
// in metres (originally millimetres). The measured axes are x left, y up, z into the box; here x
// points right, y up and z out of the box, towards the viewer. Spectra are replaced by the usual
// linear RGB values.
#include "renderer/import/builtin/builtin.h"

#include <stddef.h>

static const float white[3] = {0.725f, 0.71f, 0.68f};
static const float red[3] = {0.63f, 0.065f, 0.05f};
static const float green[3] = {0.14f, 0.45f, 0.091f};
static const float light_radiance[3] = {17.0f, 12.0f, 4.0f}; // cd/m^2

enum { FLOOR, CEILING, BACK_WALL, GREEN_WALL, RED_WALL, LIGHT, ROOM_PARTS };

// Published corners, millimetres, in the order that faces inwards once x and z are mirrored.
static const struct {
    const char *name;
    const float *reflectance;
    float corners[4][3];
} room[ROOM_PARTS] = {
    [FLOOR] = {"floor", white, {{552.8f, 0, 0}, {0, 0, 0}, {0, 0, 559.2f}, {549.6f, 0, 559.2f}}},
    [CEILING] = {"ceiling", white, {{0}}}, // has a hole for the light
    [BACK_WALL] =
        {"back wall",
         white,
         {{549.6f, 0, 559.2f}, {0, 0, 559.2f}, {0, 548.8f, 559.2f}, {556, 548.8f, 559.2f}}},
    [GREEN_WALL] = {"right wall (green)",
                    green,
                    {{0, 0, 559.2f}, {0, 0, 0}, {0, 548.8f, 0}, {0, 548.8f, 559.2f}}},
    [RED_WALL] = {"left wall (red)",
                  red,
                  {{552.8f, 0, 0}, {549.6f, 0, 559.2f}, {556, 548.8f, 559.2f}, {556, 548.8f, 0}}},
    [LIGHT] = {"lamp",
               NULL,
               {{343, 548.8f, 227}, {343, 548.8f, 332}, {213, 548.8f, 332}, {213, 548.8f, 227}}},
};

static const float short_block[5][4][3] = {
    {{130, 165, 65}, {82, 165, 225}, {240, 165, 272}, {290, 165, 114}},
    {{290, 0, 114}, {290, 165, 114}, {240, 165, 272}, {240, 0, 272}},
    {{130, 0, 65}, {130, 165, 65}, {290, 165, 114}, {290, 0, 114}},
    {{82, 0, 225}, {82, 165, 225}, {130, 165, 65}, {130, 0, 65}},
    {{240, 0, 272}, {240, 165, 272}, {82, 165, 225}, {82, 0, 225}},
};

static const float tall_block[5][4][3] = {
    {{423, 330, 247}, {265, 330, 296}, {314, 330, 456}, {472, 330, 406}},
    {{423, 0, 247}, {423, 330, 247}, {472, 330, 406}, {472, 0, 406}},
    {{472, 0, 406}, {472, 330, 406}, {314, 330, 456}, {314, 0, 456}},
    {{314, 0, 456}, {314, 330, 456}, {265, 330, 296}, {265, 0, 296}},
    {{265, 0, 296}, {265, 330, 296}, {423, 330, 247}, {423, 0, 247}},
};

// From published millimetres to metres, with the origin at the floor's centre.
static void to_metres(const float published[3], float out_position[3])
{
    out_position[0] = (278.0f - published[0]) * 1e-3f;
    out_position[1] = published[1] * 1e-3f;
    out_position[2] = (279.6f - published[2]) * 1e-3f;
}

static bool add_published_quad(struct scene *scene, const float published[4][3], uint32_t material)
{
    float corners[4][3];
    for (int i = 0; i < 4; i++)
        to_metres(published[i], corners[i]);
    return builtin_add_quad(scene, corners, material);
}

static bool add_ceiling(struct scene *scene, uint32_t material)
{
    // Four strips around the light's rectangle, so that no surfaces overlap in one plane.
    const float y = 548.8f;
    const float outer[4][2] = {{556, 0}, {556, 559.2f}, {0, 559.2f}, {0, 0}};
    const float inner[4][2] = {{343, 227}, {343, 332}, {213, 332}, {213, 227}};
    for (int i = 0; i < 4; i++) {
        int next = (i + 1) & 3;
        const float strip[4][3] = {
            {outer[i][0], y, outer[i][1]},
            {outer[next][0], y, outer[next][1]},
            {inner[next][0], y, inner[next][1]},
            {inner[i][0], y, inner[i][1]},
        };
        if (!add_published_quad(scene, strip, material))
            return false;
    }
    return true;
}

static bool add_block(struct scene *scene, const char *name, const float faces[5][4][3],
                      uint32_t material)
{
    uint32_t mesh = scene_add_mesh(scene, name);
    if (mesh == SCENE_NONE)
        return false;
    for (int i = 0; i < 5; i++)
        if (!add_published_quad(scene, faces[i], material))
            return false;
    return builtin_add_mesh_node(scene, name, mesh) != SCENE_NONE;
}

bool builtin_add_cornell_room(struct scene *scene)
{
    struct scene_material light;
    scene_material_init(&light, "lamp");
    light.base_color[0] = light.base_color[1] = light.base_color[2] = 0.78f;
    light.metallic = 0.0f;
    light.ior = 1.0f;
    light.emissive_strength = light_radiance[0];
    for (int c = 0; c < 3; c++)
        light.emissive[c] = light_radiance[c] / light_radiance[0];
    for (int i = 0; i < ROOM_PARTS; i++) {
        uint32_t mesh = scene_add_mesh(scene, room[i].name);
        uint32_t material = room[i].reflectance
                                ? builtin_add_matte(scene, room[i].name, room[i].reflectance)
                                : scene_add_material(scene, &light);
        if (mesh == SCENE_NONE || material == SCENE_NONE)
            return false;
        bool added = i == CEILING ? add_ceiling(scene, material)
                                  : add_published_quad(scene, room[i].corners, material);
        if (!added || builtin_add_mesh_node(scene, room[i].name, mesh) == SCENE_NONE)
            return false;
    }
    float eye[3], target[3];
    to_metres((const float[3]){278, 273, -800}, eye);
    to_metres((const float[3]){278, 273, 279.6f}, target);
    // 25 mm of film behind a 35 mm lens.
    return scene_add_camera(scene, "published view", eye, target, (const float[3]){0, 1, 0},
                            0.68597f) != SCENE_NONE;
}

bool builtin_build_cornell(struct scene *scene)
{
    if (!builtin_add_cornell_room(scene))
        return false;
    uint32_t material = builtin_add_matte(scene, "white blocks", white);
    return material != SCENE_NONE && add_block(scene, "short block", short_block, material) &&
           add_block(scene, "tall block", tall_block, material);
}
