// Proves that light stays in its room. Two closed rooms share a wall one voxel thick, and a light
// is in one of them: the other room receives less than 1 % of the lit room's mean indirect light. A
// wall two voxels thick lets nothing through, a rotated one 0.04 % at most. This holds wherever the
// wall lies between two voxels, and however the rooms are rotated.
//
// A voxel is the longest edge of the scene's bounds over 64, the best that a grid of that
// resolution can do. Clip levels are finer near the camera.
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

#include "support_gi.h"
#include "support_gi_scenes.h"

#define PICTURE_EDGE       32u
#define RESOLUTION         64.0
#define ONE_VOXEL_FRACTION 0.01
#define NOTHING            1e-6
// Along the edges of rotated walls a little comes through: a tenth of a step of an 8-bit image in
// which the lit room is white.
#define TURNED_NOTHING 4e-4

static const float turns_rad[] = {0.0f, 0.2f, 0.73f};
static const float offsets_voxels[] = {0.0f, 0.25f, 0.5f};

// The bounds of rotated rooms do not depend on the wall.
static double voxel_edge_m(float turn_rad)
{
    struct gi_rooms_params rooms = {.wall_m = 0.1f, .turn_rad = turn_rad};
    struct scene *scene = gi_rooms_scene(&rooms);
    double edge_m = gi_scene_extent(scene) / RESOLUTION;
    scene_destroy(&scene);
    return edge_m;
}

// Mean of the indirect light that the camera of a room sees.
static double indirect_mean(struct scene *scene, struct frame_params *params, enum gi_method method)
{
    double means[2][3];
    for (int i = 0; i < 2; i++) {
        params->settings.gi_method = i == 0 ? GI_METHOD_NONE : method;
        struct test_picture picture = gi_draw(scene, params);
        gi_mean(picture.pixels, picture.width, picture.height, means[i]);
        gi_picture_finish(&picture);
    }
    return means[1][0] - means[0][0];
}

static double room_mean(const struct gi_rooms_params *rooms, uint32_t room, enum gi_method method)
{
    struct scene *scene = gi_rooms_scene(rooms);
    struct frame_params params = gi_params(PICTURE_EDGE, PICTURE_EDGE, method);
    params.settings.voxel_resolution = VOXEL_RESOLUTION_64;
    gi_rooms_look(rooms, room, &params.camera);
    double mean = indirect_mean(scene, &params, method);
    scene_destroy(&scene);
    return mean;
}

static void check_walls_of_turn(struct gi_report *report, enum gi_method method, size_t turn,
                                int wall_voxels)
{
    // The lit room hardly depends on the wall.
    static double lit_means[GI_METHOD_COUNT][3];
    double *lit = &lit_means[method][turn], edge_m = voxel_edge_m(turns_rad[turn]);
    double nothing = turn == 0 ? NOTHING : TURNED_NOTHING;
    double allowed = wall_voxels == 1 ? ONE_VOXEL_FRACTION : nothing;
    for (size_t offset = 0; offset < 3; offset++) {
        // For rotated rooms and thick walls, the diagonal with the worst of the table is enough.
        if (!gi_test_is_full() && (turn > 0 || wall_voxels > 1) && offset != (3 - turn) % 3)
            continue;
        struct gi_rooms_params rooms = {.wall_m = (float)(wall_voxels * edge_m),
                                        .offset_m = (float)(offsets_voxels[offset] * edge_m),
                                        .turn_rad = turns_rad[turn]};
        if (*lit == 0.0)
            *lit = room_mean(&rooms, 0, method);
        double dark = room_mean(&rooms, 1, method), fraction = fabs(dark) / *lit;
        gi_check(report, *lit > 0.0 && fraction < allowed,
                 "%s, wall of %d voxels, offset %g voxels, turn %g: lit %.5g dark %.3g share %.2e "
                 "(below %g)",
                 gi_method_names[method], wall_voxels, (double)offsets_voxels[offset],
                 (double)turns_rad[turn], *lit, dark, fraction, allowed);
    }
}

static void check_walls(int wall_voxels)
{
    struct gi_report report = {0};
    for (uint32_t m = 0; m < GI_PROVED_METHODS; m++)
        for (size_t turn = 0; turn < 3; turn++)
            check_walls_of_turn(&report, gi_proved_methods[m], turn, wall_voxels);
    gi_report_finish(&report);
}

static void test_wall_of_one_voxel(void **state)
{
    (void)state;
    check_walls(1);
}

static void test_wall_of_two_voxels(void **state)
{
    (void)state;
    check_walls(2);
}

// The light that the tests above compare exists: the lit room's indirect light is that of the path
// tracer.
static void test_lit_room_is_lit(void **state)
{
    (void)state;
    struct gi_report report = {0};
    struct gi_rooms_params rooms = {.wall_m = (float)voxel_edge_m(0.0f)};
    struct scene *scene = gi_rooms_scene(&rooms);
    struct path_params path = {.scene = scene,
                               .width = 48,
                               .height = 48,
                               .samples = 64,
                               .bounces = PATH_BOUNCES_UNLIMITED};
    double expected[2];
    for (uint32_t room = 0; room < 2; room++) {
        gi_rooms_look(&rooms, room, &path.camera);
        struct path_picture traced;
        double mean[3];
        assert_true(path_trace(&path, &traced));
        gi_mean(traced.indirect, traced.width, traced.height, mean);
        expected[room] = mean[0];
        path_picture_finish(&traced);
    }
    gi_check(&report, expected[1] == 0.0, "path tracer: dark room %g", expected[1]);
    for (uint32_t m = 0; m < GI_PROVED_METHODS; m++) {
        struct frame_params params = gi_params(48, 48, gi_proved_methods[m]);
        params.settings.voxel_resolution = VOXEL_RESOLUTION_64;
        gi_rooms_look(&rooms, 0, &params.camera);
        gi_check_ratio(&report, indirect_mean(scene, &params, gi_proved_methods[m]), expected[0],
                       0.08, "%s lit room", gi_method_names[gi_proved_methods[m]]); // 0.041
    }
    scene_destroy(&scene);
    gi_report_finish(&report);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_lit_room_is_lit),
        cmocka_unit_test(test_wall_of_one_voxel),
        cmocka_unit_test(test_wall_of_two_voxels),
    };
    return cmocka_run_group_tests(tests, NULL, test_renderer_teardown);
}
