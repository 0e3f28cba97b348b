// The atrium's 256 lanterns: a mesh per colour, and a point light below each.
#include <assert.h>
#include <math.h>
#include <stdio.h>

#include "renderer/import/builtin/atrium.h"

#define LANTERN_COUNT     256
#define LANTERN_COLORS    8
#define LIGHT_DROP_M      0.26f // the light hangs below its lantern, which casts no shadow on it
#define STRINGS           8
#define LANTERNS_A_STRING 7

enum hanging { HANG_FROM_ABOVE, HANG_AT_WALL, HANG_ON_STRING, HANGINGS };

struct lantern_maker {
    struct scene *scene;
    uint32_t group;
    uint32_t meshes[HANGINGS][LANTERN_COLORS];
    int count;
};

static const float colors[LANTERN_COLORS][3] = {
    {1.0f, 0.55f, 0.2f}, {1.0f, 0.2f, 0.1f},   {0.2f, 0.9f, 0.35f}, {0.25f, 0.45f, 1.0f},
    {1.0f, 0.75f, 0.3f}, {0.85f, 0.25f, 1.0f}, {0.2f, 0.85f, 1.0f}, {1.0f, 0.3f, 0.55f},
};

static uint32_t make_lantern(struct scene *scene, uint32_t glass, enum hanging hanging)
{
    static const struct profile_point frame[] = {
        {0.05f, 0.07f, 0},  {0.095f, 0.07f, 0}, {0.095f, 0.085f, 0}, {0.06f, 0.12f, 1},
        {0.025f, 0.14f, 0}, {0.02f, 0.17f, 0},  {0.0f, 0.18f, 0},
    };
    struct mesh_builder builder;
    mesh_builder_init(&builder);
    mesh_builder_add_sphere(&builder, (float[3]){0, 0, 0}, 0.09f, 14, 10);
    uint32_t mesh = mesh_builder_commit_mesh(&builder, scene, "lantern", glass);
    mesh_builder_add_lathe(&builder, frame, sizeof(frame) / sizeof(frame[0]), 14);
    float top = hanging == HANG_FROM_ABOVE ? 0.78f : 0.27f;
    mesh_builder_add_rod(&builder, (float[3]){0, 0.17f, 0}, (float[3]){0, top, 0}, 0.008f, 6);
    if (hanging == HANG_AT_WALL)
        mesh_builder_add_rod(&builder, (float[3]){0, 0.26f, -0.02f}, (float[3]){0, 0.26f, 0.3f},
                             0.012f, 8);
    return mesh_builder_commit(&builder, scene, ATRIUM_BRASS) ? mesh : SCENE_NONE;
}

static bool make_lanterns(struct lantern_maker *maker)
{
    for (int color = 0; color < LANTERN_COLORS; color++) {
        char name[64];
        snprintf(name, sizeof(name), "lantern glass %d", color + 1);
        struct scene_material glass;
        scene_material_init(&glass, name);
        glass.metallic = 0.0f;
        glass.roughness = 0.6f;
        glass.emissive_strength = 0.8f;
        glm_vec3_copy((float *)colors[color], glass.emissive);
        glm_vec3_copy((float *)colors[color], glass.base_color);
        uint32_t material = scene_add_material(maker->scene, &glass);
        for (enum hanging hanging = 0; hanging < HANGINGS; hanging++) {
            uint32_t mesh = make_lantern(maker->scene, material, hanging);
            if (mesh == SCENE_NONE)
                return false;
            maker->meshes[hanging][color] = mesh;
        }
    }
    return true;
}

// Position of a lantern; `turn_rad` rotates +Z to its wall.
struct lantern_placement {
    enum hanging hanging;
    float x, y, z, turn_rad;
};

static bool add_lantern(struct lantern_maker *maker, const struct lantern_placement *placement)
{
    int color = (maker->count * 5 + maker->count / LANTERN_COLORS * 3) % LANTERN_COLORS;
    char name[64];
    snprintf(name, sizeof(name), "lantern %03d", maker->count + 1);
    struct scene_light light;
    scene_light_init(&light, SCENE_LIGHT_POINT, name);
    glm_vec3_copy((float *)colors[color], light.color);
    light.intensity = 1.2f;
    light.range_m = 2.0f + (float)(maker->count % 5) * 0.5f;
    light.casts_shadow = maker->count % 64 == 0;
    maker->count++;
    return atrium_add_node(maker->scene, name, maker->group,
                           maker->meshes[placement->hanging][color],
                           (float[3]){placement->x, placement->y, placement->z},
                           placement->turn_rad) != SCENE_NONE &&
           scene_add_light(maker->scene, &light,
                           (float[3]){placement->x, placement->y - LIGHT_DROP_M, placement->z},
                           (float[3]){0, -1, 0}) != SCENE_NONE;
}

// In each bay on each floor: in the arch, in the middle of the gallery and two at the wall.
static bool add_bay_lanterns(struct lantern_maker *maker, const struct atrium_bay *bay)
{
    static const struct lantern_placement placements[] = {
        {HANG_FROM_ABOVE, 0, 3.72f, 0, 0},      {HANG_FROM_ABOVE, 0, 3.98f, 1.5f, 0},
        {HANG_AT_WALL, -1.12f, 2.4f, 2.75f, 0}, {HANG_AT_WALL, 1.12f, 2.4f, 2.75f, 0},
        {HANG_FROM_ABOVE, 0, 8.92f, 0, 0},      {HANG_FROM_ABOVE, 0, 9.16f, 1.55f, 0},
        {HANG_AT_WALL, -1.12f, 7.7f, 2.75f, 0}, {HANG_AT_WALL, 1.12f, 7.7f, 2.75f, 0},
    };
    for (size_t i = 0; i < sizeof(placements) / sizeof(placements[0]); i++) {
        struct lantern_placement placement = placements[i];
        float xz[2];
        atrium_bay_point(bay, placement.x, placement.z, xz);
        placement.x = xz[0];
        placement.z = xz[1];
        placement.turn_rad = bay->turn_rad;
        if (!add_lantern(maker, &placement))
            return false;
    }
    return true;
}

// In each corner of the galleries on each floor: one in the middle and two at the walls.
static bool add_corner_lanterns(struct lantern_maker *maker)
{
    static const float offsets[3][2] = {{0, 0}, {1.25f, 0}, {0, 1.25f}};
    for (int i = 0; i < 24; i++) {
        int corner = i / 6, upper = i / 3 % 2, which = i % 3;
        float x = ATRIUM_COURT_HALF_X + 1.5f + offsets[which][0];
        float z = ATRIUM_COURT_HALF_Z + 1.5f + offsets[which][1];
        bool right = corner & 1, front = corner & 2;
        struct lantern_placement placement = {
            .hanging = which ? HANG_AT_WALL : HANG_FROM_ABOVE,
            .x = right ? x : -x,
            .y = upper ? (which ? 7.7f : 9.16f) : (which ? 2.4f : 3.98f),
            .z = front ? z : -z,
        };
        if (which == 1)
            placement.turn_rad = right ? (float)M_PI_2 : -(float)M_PI_2;
        else if (!front)
            placement.turn_rad = (float)M_PI;
        if (!add_lantern(maker, &placement))
            return false;
    }
    return true;
}

static float string_height(float z)
{
    return 4.3f + 0.045f * z * z;
}

// On cords across the court, from cornice to cornice.
static bool add_strings(struct lantern_maker *maker)
{
    const int pieces = 16;
    const float reach = ATRIUM_COURT_HALF_Z - 0.3f;
    struct mesh_builder builder;
    mesh_builder_init(&builder);
    for (int string = 0; string < STRINGS; string++) {
        float x = ((float)string - 0.5f * (STRINGS - 1)) * ATRIUM_BAY_M;
        for (int i = 0; i < pieces; i++) {
            float from = reach * (2.0f * (float)i / (float)pieces - 1.0f);
            float to = reach * (2.0f * (float)(i + 1) / (float)pieces - 1.0f);
            mesh_builder_add_rod(&builder, (float[3]){x, string_height(from), from},
                                 (float[3]){x, string_height(to), to}, 0.007f, 5);
        }
        for (int i = 0; i < LANTERNS_A_STRING; i++) {
            float z = (float)i - 0.5f * (LANTERNS_A_STRING - 1);
            struct lantern_placement placement = {HANG_ON_STRING, x, string_height(z) - 0.265f, z,
                                                  0};
            if (!add_lantern(maker, &placement)) {
                mesh_builder_finish(&builder);
                return false;
            }
        }
    }
    uint32_t mesh = mesh_builder_commit_mesh(&builder, maker->scene, "strings", ATRIUM_BRASS);
    return mesh != SCENE_NONE && atrium_add_node(maker->scene, "strings", maker->group, mesh,
                                                 (float[3]){0, 0, 0}, 0.0f) != SCENE_NONE;
}

bool atrium_add_lanterns(struct scene *scene)
{
    struct lantern_maker maker = {
        .scene = scene,
        .group = scene_add_node(scene, "lanterns", SCENE_NONE),
    };
    if (maker.group == SCENE_NONE || !make_lanterns(&maker))
        return false;
    for (int i = 0; i < ATRIUM_BAY_COUNT; i++) {
        struct atrium_bay bay = atrium_bay(i);
        if (!add_bay_lanterns(&maker, &bay))
            return false;
    }
    if (!add_corner_lanterns(&maker) || !add_strings(&maker))
        return false;
    assert(maker.count == LANTERN_COUNT);
    return true;
}
