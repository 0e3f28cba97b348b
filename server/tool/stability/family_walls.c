// Light stays in its room. Two closed rooms share a wall; a light is in one of them. Measures what
// the camera in the dark room sees over what it sees in the lit one. A voxel is the longest edge of
// the bounds over 64.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "renderer/import/builtin/builtin.h"
#include "renderer/metrics/picture.h"
#include "server/tool/stability/stage.h"

#define HALF_EXTENT_M 2.0f
#define PLACEMENTS    8

struct rooms {
    float wall_voxels;
    float offset_voxels;
    float turn_rad;
    vec3 axis;
};

static void turned(const struct rooms *rooms, const float vector[3], float out_vector[3])
{
    versor rotation;
    glm_quatv(rotation, rooms->turn_rad, (float *)rooms->axis);
    glm_quat_rotatev(rotation, (float *)vector, out_vector);
}

// Orientations of a wall; the first is along the axes.
static struct rooms rooms_of(int number, float wall_voxels)
{
    return (struct rooms){.wall_voxels = wall_voxels,
                          .offset_voxels = 0.25f * (float)(number * 3 % 4),
                          .turn_rad = 0.37f * (float)number,
                          .axis = {1.0f, 0.5f * (float)(number % 3), 0.25f * (float)(number % 5)}};
}

static void add_inside(struct mesh_builder *builder, const float low[3], const float high[3])
{
    for (int face = 0; face < 6; face++) {
        int axis = face / 2, u = (axis + 1) % 3, v = (axis + 2) % 3;
        float corners[4][3];
        for (int corner = 0; corner < 4; corner++) {
            int k = face % 2 ? 3 - corner : corner;
            corners[corner][axis] = face % 2 ? high[axis] : low[axis];
            corners[corner][u] = k == 1 || k == 2 ? high[u] : low[u];
            corners[corner][v] = k >= 2 ? high[v] : low[v];
        }
        mesh_builder_add_quad(builder, corners);
    }
}

// Half the longest edge of the bounds of the rotated cube, as voxels cover it.
static float half_bounds(const struct rooms *rooms)
{
    float maximum = 0.0f;
    for (int axis = 0; axis < 3; axis++) {
        float sum = 0.0f;
        for (int edge = 0; edge < 3; edge++) {
            float unit[3] = {0}, world[3];
            unit[edge] = HALF_EXTENT_M;
            turned(rooms, unit, world);
            sum += fabsf(world[axis]);
        }
        maximum = fmaxf(maximum, sum);
    }
    return maximum;
}

static struct scene *create_rooms(const struct rooms *rooms)
{
    struct scene *scene = scene_create("rooms");
    if (!scene)
        return NULL;
    uint32_t plaster = builtin_add_matte(scene, "plaster", (const float[3]){0.7f, 0.7f, 0.7f});
    float e = HALF_EXTENT_M, voxel_m = 2.0f * half_bounds(rooms) / 64.0f;
    float middle = rooms->offset_voxels * voxel_m, half = 0.5f * rooms->wall_voxels * voxel_m;
    struct mesh_builder builder;
    mesh_builder_init(&builder);
    add_inside(&builder, (const float[3]){-e, -e, -e}, (const float[3]){middle - half, e, e});
    add_inside(&builder, (const float[3]){middle + half, -e, -e}, (const float[3]){e, e, e});
    uint32_t mesh = mesh_builder_commit_mesh(&builder, scene, "rooms", plaster);
    uint32_t node = builtin_add_mesh_node(scene, "rooms", mesh);
    if (node != SCENE_NONE)
        glm_quatv(scene->nodes[node].rotation, rooms->turn_rad, (float *)rooms->axis);
    struct scene_light light;
    scene_light_init(&light, SCENE_LIGHT_POINT, "lamp");
    light.intensity = 10.0f;
    float position[3];
    turned(rooms, (const float[3]){-1.0f, 0.3f, 0.2f}, position);
    scene_add_light(scene, &light, position, (const float[3]){0.0f, -1.0f, 0.0f});
    scene_update_world_transforms(scene);
    return scene;
}

// Mean of what the camera in a room sees: 0 is the lit room.
static bool room_mean(struct stability_run *run, const struct rooms *rooms, int room,
                      enum quality quality, double *out_mean)
{
    struct scene *scene = create_rooms(rooms);
    struct frame_params params = stability_params(run);
    struct picture picture = {0};
    float side = room == 0 ? -1.0f : 1.0f, e = HALF_EXTENT_M;
    if (!scene)
        return false;
    turned(rooms, (const float[3]){side * 0.9f * e, 0.7f * e, 0.8f * e}, params.camera.eye);
    turned(rooms, (const float[3]){0.0f, -0.3f * e, -0.2f * e}, params.camera.target);
    turned(rooms, (const float[3]){0.0f, 1.0f, 0.0f}, params.camera.up);
    params.camera.fov_y_rad = 1.7f;
    params.width = params.height = 24;
    // With rays, what leaks into voxels arrives with the second bounce.
    params.settings.bounces = quality == QUALITY_INTERACTIVE ? 1 : 2;
    params.settings.clip_levels = 0;
    params.quality = quality;
    if (quality != QUALITY_INTERACTIVE)
        params.settings.gather_mode = GATHER_AUTO;
    bool done = stability_draw(run, scene, &params, &picture);
    *out_mean = done ? stability_mean(&picture) : 0.0;
    picture_finish(&picture);
    scene_destroy(&scene);
    return done;
}

// `variant` is the wall's thickness in tenths of a voxel.
static void run_placements(struct stability_run *run)
{
    double lit;
    struct rooms first = rooms_of(0, 1.0f);
    if (!room_mean(run, &first, 0, QUALITY_INTERACTIVE, &lit))
        return;
    for (int i = 0; i < PLACEMENTS; i++) {
        double dark;
        struct rooms rooms = rooms_of(i, 0.1f * (float)run->test->variant);
        if (!room_mean(run, &rooms, 1, QUALITY_INTERACTIVE, &dark))
            return;
        stability_measure(run, dark / lit, "turn %.2f, offset %.2f voxels", (double)rooms.turn_rad,
                          (double)rooms.offset_voxels);
    }
}

// `variant` is the preset.
static void run_preset(struct stability_run *run)
{
    enum quality quality = (enum quality)run->test->variant;
    struct rooms rooms = rooms_of(2, 1.0f);
    double lit, dark;
    if (room_mean(run, &rooms, 0, QUALITY_INTERACTIVE, &lit) &&
        room_mean(run, &rooms, 1, quality, &dark))
        stability_measure(run, dark / lit, "turn %.2f", (double)rooms.turn_rad);
}

#define OF_LIT "of the lit room"

static const struct stability_case cases[] = {
    {.name = "wall-0.1",
     .invariant = "walls 0.1 voxels thick, 8 orientations and offsets: light of the room next door",
     .methods = STABILITY_VOXELS,
     .bound = 0.1,
     .unit = OF_LIT,
     .run = run_placements,
     .variant = 1},
    {.name = "wall-1",
     .invariant = "the same of walls 1 voxel thick",
     .methods = STABILITY_VOXELS,
     .bound = 0.0027, // measured: 0.00134
     .unit = OF_LIT,
     .run = run_placements,
     .variant = 10},
    {.name = "wall-2",
     .invariant = "the same of walls 2 voxels thick",
     .methods = STABILITY_VOXELS,
     .bound = 1e-4, // measured: 4.83e-5
     .unit = OF_LIT,
     .run = run_placements,
     .variant = 20},
    {.name = "wall-draft",
     .invariant = "a wall 1 voxel thick with the preset draft",
     .methods = STABILITY_CLIPMAP,
     .bound = 0.0026, // measured: 0.00131
     .unit = OF_LIT,
     .run = run_preset,
     .variant = QUALITY_DRAFT},
    {.name = "wall-high",
     .invariant = "a wall 1 voxel thick with the preset high",
     .methods = STABILITY_CLIPMAP,
     .bound = 0.0021, // measured: 0.00108
     .unit = OF_LIT,
     .run = run_preset,
     .variant = QUALITY_HIGH},
    {.name = "wall-final",
     .invariant = "a wall 1 voxel thick with the preset final",
     .methods = STABILITY_CLIPMAP,
     .bound = 0.0021, // measured: 0.00107
     .unit = OF_LIT,
     .run = run_preset,
     .variant = QUALITY_FINAL},
};

const struct stability_table stability_walls = {
    .name = "walls",
    .title = "Walls",
    .cases = cases,
    .count = sizeof(cases) / sizeof(cases[0]),
};
