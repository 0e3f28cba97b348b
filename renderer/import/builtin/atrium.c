// The atrium: a courtyard between arcades on two floors, modelled on no particular palace. 30 m x
// 15 m inside its outer walls, 12 m high. Each repeated part is one mesh, instanced by many nodes.
#include "renderer/import/builtin/atrium.h"

#include <math.h>
#include <stdio.h>

#include "renderer/import/builtin/builtin.h"

uint32_t atrium_add_node(struct scene *scene, const char *name, uint32_t parent, uint32_t mesh,
                         const float position[3], float turn_rad)
{
    uint32_t node = scene_add_node(scene, name, parent);
    if (node == SCENE_NONE)
        return SCENE_NONE;
    scene->nodes[node].mesh = mesh;
    glm_vec3_copy((float *)position, scene->nodes[node].translation);
    glm_quatv(scene->nodes[node].rotation, turn_rad, (vec3){0, 1, 0});
    return node;
}

struct atrium_bay atrium_bay(int index)
{
    struct atrium_bay bay = {.number = index};
    while (bay.number >= (bay.side & 1 ? ATRIUM_BAYS_Z : ATRIUM_BAYS_X)) {
        bay.number -= bay.side & 1 ? ATRIUM_BAYS_Z : ATRIUM_BAYS_X;
        bay.side++;
    }
    bay.side_bays = bay.side & 1 ? ATRIUM_BAYS_Z : ATRIUM_BAYS_X;
    bay.turn_rad = (float)M_PI_2 * (float)bay.side;
    float along = ((float)bay.number + 0.5f - 0.5f * (float)bay.side_bays) * ATRIUM_BAY_M;
    static const float outward[4][2] = {{0, 1}, {1, 0}, {0, -1}, {-1, 0}};
    const float *out = outward[bay.side];
    bay.x = out[0] * ATRIUM_COURT_HALF_X + out[1] * along;
    bay.z = out[1] * ATRIUM_COURT_HALF_Z - out[0] * along;
    return bay;
}

void atrium_bay_point(const struct atrium_bay *bay, float x, float z, float out_xz[2])
{
    float c = cosf(bay->turn_rad), s = sinf(bay->turn_rad);
    out_xz[0] = bay->x + c * x + s * z;
    out_xz[1] = bay->z - s * x + c * z;
}

// A part of a bay: x, z in the bay, y in the world.
struct bay_part {
    const char *name;
    uint32_t mesh;
    float x, y, z;
};

static bool add_in_bay(struct scene *scene, uint32_t parent, const struct atrium_bay *bay,
                       const struct bay_part *part)
{
    float xz[2];
    char name[64];
    atrium_bay_point(bay, part->x, part->z, xz);
    snprintf(name, sizeof(name), "%s %d.%d", part->name, bay->side + 1, bay->number + 1);
    return atrium_add_node(scene, name, parent, part->mesh, (float[3]){xz[0], part->y, xz[1]},
                           bay->turn_rad) != SCENE_NONE;
}

static bool add_parts(struct scene *scene, uint32_t parent, const struct atrium_bay *bay,
                      const struct bay_part *parts, size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (!add_in_bay(scene, parent, bay, &parts[i]))
            return false;
    return true;
}

// The bay's own parts, and those on the axis at its left end.
static bool add_bay(struct scene *scene, const struct atrium_parts *parts, int index,
                    const uint32_t groups[2])
{
    struct atrium_bay bay = atrium_bay(index);
    const float half = 0.5f * ATRIUM_BAY_M;
    const float ground = ATRIUM_GROUND_FLOOR_M, upper = ATRIUM_UPPER_FLOOR_M;
    const struct bay_part ground_parts[] = {
        {"arch", parts->arch, 0, ATRIUM_GROUND_SPRING_M, 0},
        {"vault", parts->vault, 0, ATRIUM_GROUND_SPRING_M, 0},
        {"rib", parts->rib, -half, ATRIUM_GROUND_SPRING_M, 0},
        {"pilaster", parts->pilaster, -half, ground, 0},
    };
    const struct bay_part upper_parts[] = {
        {"upper arch", parts->arch, 0, ATRIUM_UPPER_SPRING_M, 0},
        {"balustrade", parts->balustrade, 0, upper + 0.02f, 0},
        {"coffers", parts->coffers, 0, ATRIUM_CEILING_M, 0},
    };
    if (!add_parts(scene, groups[0], &bay, ground_parts, 4) ||
        !add_parts(scene, groups[1], &bay, upper_parts, 3))
        return false;
    if (bay.number > 0) {
        const struct bay_part column = {"column", parts->ground_column, -half, ground, 0};
        const struct bay_part upper_column = {"upper column", parts->upper_column, -half, upper, 0};
        if (!add_in_bay(scene, groups[0], &bay, &column) ||
            !add_in_bay(scene, groups[1], &bay, &upper_column))
            return false;
    }
    const struct bay_part doors[] = {
        {"door", parts->door, 0, ground, 0},
        {"upper door", parts->door, 0, upper, 0},
    };
    return (bay.number % 2 == 0 || add_in_bay(scene, groups[0], &bay, &doors[0])) &&
           (bay.number % 2 == 1 || add_in_bay(scene, groups[1], &bay, &doors[1]));
}

// The pier at the right end of a side, the corner of the galleries behind it, and the rib and
// pilaster that the next bay would have added.
static bool add_corner(struct scene *scene, const struct atrium_parts *parts, int last_bay,
                       const uint32_t groups[2])
{
    struct atrium_bay bay = atrium_bay(last_bay);
    const float half = 0.5f * ATRIUM_BAY_M;
    const struct bay_part ground_parts[] = {
        {"corner pier", parts->ground_pier, half, ATRIUM_GROUND_FLOOR_M, 0},
        {"corner vault", parts->vault, ATRIUM_BAY_M, ATRIUM_GROUND_SPRING_M, 0},
        {"corner rib", parts->rib, half, ATRIUM_GROUND_SPRING_M, 0},
        {"corner pilaster", parts->pilaster, half, ATRIUM_GROUND_FLOOR_M, 0},
    };
    const struct bay_part upper_parts[] = {
        {"upper corner pier", parts->upper_pier, half, ATRIUM_UPPER_FLOOR_M, 0},
        {"corner coffers", parts->coffers, ATRIUM_BAY_M, ATRIUM_CEILING_M, 0},
    };
    return add_parts(scene, groups[0], &bay, ground_parts, 4) &&
           add_parts(scene, groups[1], &bay, upper_parts, 2);
}

static bool add_building(struct scene *scene)
{
    struct atrium_parts parts;
    if (!atrium_make_parts(scene, &parts) || !atrium_add_rings(scene))
        return false;
    const uint32_t groups[2] = {scene_add_node(scene, "ground floor", SCENE_NONE),
                                scene_add_node(scene, "upper floor", SCENE_NONE)};
    if (groups[0] == SCENE_NONE || groups[1] == SCENE_NONE)
        return false;
    for (int i = 0; i < ATRIUM_BAY_COUNT; i++) {
        struct atrium_bay bay = atrium_bay(i);
        if (!add_bay(scene, &parts, i, groups) ||
            (bay.number == bay.side_bays - 1 && !add_corner(scene, &parts, i, groups)))
            return false;
    }
    struct mesh_builder builder;
    mesh_builder_init(&builder);
    const float x = ATRIUM_COURT_HALF_X + 3.4f, z = ATRIUM_COURT_HALF_Z + 3.4f;
    mesh_builder_add_box(&builder, (float[3]){-x, -0.4f, -z}, (float[3]){x, 0.0f, z}, BOX_ALL);
    uint32_t mesh = mesh_builder_commit_mesh(&builder, scene, "courtyard floor", ATRIUM_MARBLE);
    return mesh != SCENE_NONE &&
           builtin_add_mesh_node(scene, "courtyard floor", mesh) != SCENE_NONE;
}

static bool add_cloth(struct scene *scene, const struct atrium_furnishings *furnishings)
{
    uint32_t group = scene_add_node(scene, "cloth", SCENE_NONE);
    if (group == SCENE_NONE)
        return false;
    for (int i = 0; i < ATRIUM_BAY_COUNT; i++) {
        struct atrium_bay bay = atrium_bay(i);
        int color = (bay.number + bay.side) % 3;
        const struct bay_part curtains = {"curtains", furnishings->curtains[color], 0,
                                          ATRIUM_GROUND_FLOOR_M, 0};
        const struct bay_part banner = {"banner", furnishings->banners[(color + 1) % 3], 0, 0, 0};
        bool has_curtains = bay.side & 1 ? bay.number != 1 : bay.number % 3 != 2;
        bool has_banner = !(bay.side & 1) && bay.number % 2 == bay.side / 2;
        if ((has_curtains && !add_in_bay(scene, group, &bay, &curtains)) ||
            (has_banner && !add_in_bay(scene, group, &bay, &banner)))
            return false;
    }
    return true;
}

static bool add_plants(struct scene *scene, uint32_t mesh)
{
    uint32_t group = scene_add_node(scene, "plants", SCENE_NONE);
    bool placed = group != SCENE_NONE;
    for (int i = 0; placed && i < ATRIUM_BAY_COUNT; i++) {
        struct atrium_bay bay = atrium_bay(i);
        float xz[2];
        // In front of every other column, and two in each corner of the court.
        if (bay.number % 2 == 0)
            atrium_bay_point(&bay, bay.number ? -1.5f : -0.55f, -1.0f, xz);
        else
            continue;
        placed = atrium_add_node(scene, "potted plant", group, mesh, (float[3]){xz[0], 0.0f, xz[1]},
                                 1.7f * (float)i) != SCENE_NONE;
    }
    return placed;
}

static bool add_cameras(struct scene *scene)
{
    static const struct {
        const char *name;
        float eye[3], target[3], fov_y_rad;
    } cameras[] = {
        {"courtyard", {-11.0f, 1.75f, 1.7f}, {0.0f, 4.0f, -0.9f}, 1.1f},
        {"gallery", {-11.2f, 1.8f, 6.5f}, {2.0f, 2.1f, 5.6f}, 1.05f},
        {"upper floor", {-10.6f, 7.05f, 5.9f}, {2.5f, 5.6f, -3.2f}, 1.05f},
        {"plants", {-4.3f, 1.35f, -1.7f}, {-6.0f, 0.85f, -3.6f}, 0.9f},
        {"from above", {-17.0f, 17.0f, 13.0f}, {0.0f, 4.0f, 0.0f}, 0.9f},
    };
    for (size_t i = 0; i < sizeof(cameras) / sizeof(cameras[0]); i++)
        if (scene_add_camera(scene, cameras[i].name, cameras[i].eye, cameras[i].target,
                             (float[3]){0, 1, 0}, cameras[i].fov_y_rad) == SCENE_NONE)
            return false;
    return true;
}

static bool add_all_but_light(struct scene *scene)
{
    struct atrium_furnishings furnishings;
    return atrium_add_materials(scene) && add_building(scene) &&
           atrium_make_furnishings(scene, &furnishings) && add_cloth(scene, &furnishings) &&
           add_plants(scene, furnishings.plant) &&
           atrium_add_node(scene, "fountain", SCENE_NONE, furnishings.fountain, (float[3]){0, 0, 0},
                           0.0f) != SCENE_NONE &&
           add_cameras(scene);
}

// `brightness` 1 is a clear day in units of 1 000 lux.
static bool add_sky(struct scene *scene, float brightness, const float sun_color[3])
{
    struct scene_light sun;
    scene_light_init(&sun, SCENE_LIGHT_DIRECTIONAL, "sun");
    sun.intensity = 10.0f * brightness;
    glm_vec3_copy((float *)sun_color, sun.color);
    struct scene_environment sky = {
        .type = SCENE_ENVIRONMENT_GRADIENT,
        .intensity = brightness,
        .color = {0.16f, 0.3f, 0.62f},
        .horizon_color = {0.55f, 0.65f, 0.78f},
        .ground_color = {0.16f, 0.15f, 0.13f},
    };
    scene_set_environment(scene, &sky);
    return scene_add_light(scene, &sun, (float[3]){-6, 14, 5}, (float[3]){0.42f, -1.0f, -0.36f}) !=
           SCENE_NONE;
}

bool builtin_build_atrium(struct scene *scene)
{
    return add_all_but_light(scene) && add_sky(scene, 1.0f, (float[3]){1.0f, 0.95f, 0.86f});
}

bool builtin_build_atrium_lights(struct scene *scene)
{
    // Dusk: a moon in the sun's position.
    return add_all_but_light(scene) && add_sky(scene, 0.004f, (float[3]){0.7f, 0.8f, 1.0f}) &&
           atrium_add_lanterns(scene);
}
