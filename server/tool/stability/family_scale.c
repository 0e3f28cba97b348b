// The image depends neither on the unit of a scene nor on its position.
#include <math.h>
#include <string.h>

#include "renderer/camera.h"
#include "renderer/import/builtin/builtin.h"
#include "renderer/metrics/picture.h"
#include "server/tool/stability/stage.h"

static bool draw_stage(struct stability_run *run, const struct stage_params *placement,
                       struct picture *out_picture)
{
    struct stage stage;
    *out_picture = (struct picture){0};
    return stage_create(run, placement, &stage) && stage_draw(run, &stage, out_picture);
}

// Measures how far the stage looks from the same stage in its usual position.
static void compare_positions(struct stability_run *run, const struct stage_params *placements,
                              uint32_t count, const char *const *names)
{
    struct picture expected;
    if (!stage_draw_usual(run, &expected))
        return;
    stability_keep(run, &expected, "usual");
    for (uint32_t i = 0; i < count; i++) {
        struct picture test;
        if (!draw_stage(run, &placements[i], &test))
            break;
        stability_measure(run, stability_flip(&test, &expected), "%s", names[i]);
        stability_keep(run, &test, names[i]);
        picture_finish(&test);
    }
    picture_finish(&expected);
}

// `variant` is the power of ten.
static void run_scaled(struct stability_run *run)
{
    const struct stage_params placement = {.scale = pow(10.0, run->test->variant)};
    compare_positions(run, &placement, 1, &(const char *){"scaled"});
}

static void run_moved(struct stability_run *run)
{
    double far = pow(10.0, run->test->variant);
    const struct stage_params placements[] = {{.offset = {far, 0.0, 0.0}},
                                              {.offset = {far, -far, far}}};
    static const char *const names[] = {"along-x", "along-all"};
    compare_positions(run, placements, 2, names);
}

// Voxels of the stage, as a debug view shows them.
static bool draw_voxels(struct stability_run *run, enum debug_view view, const double offset[3],
                        struct picture *out_picture)
{
    struct stage_params placement = {0};
    struct stage stage;
    memcpy(placement.offset, offset, sizeof(placement.offset));
    *out_picture = (struct picture){0};
    if (!stage_create(run, &placement, &stage))
        return false;
    struct frame_params params = stability_params(run);
    params.camera = stage.camera;
    params.settings.bounces = 1;
    params.debug_view = view;
    bool done = stability_draw(run, stage.scene, &params, out_picture);
    scene_destroy(&stage.scene);
    return done;
}

// `variant`: 0 compares what is in voxels; 1 compares their light.
static void run_moved_voxels(struct stability_run *run)
{
    static const double here[3] = {0.0, 0.0, 0.0}, there[3] = {3.0, -1.0, 2.0};
    static const enum debug_view views[2][2] = {{DEBUG_VIEW_VOXEL_ALBEDO, DEBUG_VIEW_VOXEL_NORMAL},
                                                {DEBUG_VIEW_VOXEL_RADIANCE, DEBUG_VIEW_COUNT}};
    for (int i = 0; i < 2 && views[run->test->variant][i] != DEBUG_VIEW_COUNT; i++) {
        enum debug_view view = views[run->test->variant][i];
        struct picture expected = {0}, test = {0};
        if (draw_voxels(run, view, here, &expected) && draw_voxels(run, view, there, &test)) {
            uint32_t pixel = 0;
            double difference = stability_difference(&test, &expected, &pixel);
            bool counts = run->test->variant == 0;
            stability_measure(
                run, counts ? (double)stability_count_changed(&test, &expected) : difference,
                "%s, pixel %u, %u", debug_view_names[view], pixel % test.width, pixel / test.width);
        }
        picture_finish(&expected);
        picture_finish(&test);
    }
}

#define DEPTH_ALBEDO 0.5

// A square of D x D m that faces the camera at D m, lit by a light D / 4 in front of it: how far
// its pixels are from the inverse square times the cosine. The light depends on positions that are
// found from depth, and errs by about eight times their error. With `reach`, a speck that far
// behind enlarges the scene.
static void measure_depth(struct stability_run *run, double distance, double reach)
{
    struct stage stage = {.scene = scene_create("square"), .scale = 1.0};
    if (!stage.scene)
        return;
    uint32_t material = builtin_add_matte(stage.scene, "matte", (const float[3]){0.5f, 0.5f, 0.5f});
    float half = (float)(0.5 * distance), far = (float)-reach;
    const struct scene_vertex square[6] = {
        stage_vertex(-half, -half, 0.0f), stage_vertex(half, -half, 0.0f),
        stage_vertex(half, half, 0.0f),   stage_vertex(-half, -half, 0.0f),
        stage_vertex(half, half, 0.0f),   stage_vertex(-half, half, 0.0f)};
    const struct scene_vertex speck[3] = {stage_vertex(0.0f, 0.0f, far),
                                          stage_vertex(half, 0.0f, far),
                                          stage_vertex(0.0f, half, far)};
    static const float origin[3] = {0};
    struct scene_vertex front[6];
    for (int i = 0; i < 6; i++) {
        front[i] = square[i];
        memcpy(front[i].normal, (float[3]){0.0f, 0.0f, 1.0f}, sizeof(front[i].normal));
    }
    stage_add_triangles(&stage, front, 2, material, origin);
    if (reach > 0.0)
        stage_add_triangles(&stage, speck, 1, material, origin);
    struct scene_light light;
    scene_light_init(&light, SCENE_LIGHT_POINT, "lamp");
    double height = 0.25 * distance;
    light.intensity = (float)(height * height);
    light.casts_shadow = false;
    scene_add_light(stage.scene, &light, (const float[3]){0.0f, 0.0f, (float)height},
                    (const float[3]){0.0f, 0.0f, -1.0f});
    scene_update_world_transforms(stage.scene);
    struct frame_params params = stability_params(run);
    params.camera.eye[2] = (float)distance;
    params.camera.fov_y_rad = 0.8f;
    struct picture picture;
    stability_draw(run, stage.scene, &params, &picture);
    scene_destroy(&stage.scene);
    struct camera_frame frame;
    camera_frame_init(&frame, &params.camera);
    for (uint32_t i = 0; picture.rgb && i < picture.width * picture.height; i++) {
        float ray[3];
        camera_ray(&frame, picture.width, picture.height, (float)(i % picture.width) + 0.5f,
                   (float)(i / picture.width) + 0.5f, ray);
        double x = ray[0] * distance, y = ray[1] * distance;
        if (fabs(x) > 0.49 * distance || fabs(y) > 0.49 * distance)
            continue;
        double squared = x * x + y * y + height * height;
        double expected =
            DEPTH_ALBEDO / M_PI * height * height * height / (squared * sqrt(squared));
        stability_measure(run, fabs(picture.rgb[3 * (size_t)i] / expected - 1.0),
                          "pixel %u, %u, %g m away, scene of %g m", i % picture.width,
                          i / picture.width, distance, reach);
    }
    picture_finish(&picture);
}

static void run_depth(struct stability_run *run)
{
    for (int power = -2; power <= 5; power++) {
        measure_depth(run, pow(10.0, power), 0.0);
        measure_depth(run, pow(10.0, power), 3e5);
    }
}

#define SCALED(power, text)                                                                        \
    {                                                                                              \
        .name = "scaled-" text,                                                                    \
        .invariant =                                                                               \
            "scene, lights and camera times " text " (candela times its square) look the same",    \
        .methods = STABILITY_ALL, .bound = 0.0028, .unit = "mean FLIP", .run = run_scaled,         \
        .variant = (power),                                                                        \
    }

static const struct stability_case cases[] = {
    SCALED(-4, "1e-4"),
    SCALED(-2, "1e-2"),
    SCALED(2, "1e2"),
    SCALED(5, "1e5"),
    {.name = "moved-1e5",
     .invariant = "100 km from the origin the image is the same",
     .methods = STABILITY_ALL,
     .bound = 0.01,
     .unit = "mean FLIP",
     .run = run_moved,
     .variant = 5},
    {.name = "moved-1e6",
     .invariant = "1000 km from the origin the image is the same",
     .methods = STABILITY_ALL,
     .bound = 0.01,
     .unit = "mean FLIP",
     .run = run_moved,
     .variant = 6},
    {.name = "moved-voxels",
     .invariant = "moved by what floats hold exactly, what is in voxels is the same bit by bit",
     .methods = STABILITY_VOXELS,
     .bound = 0.0,
     .unit = "channels changed",
     .run = run_moved_voxels},
    {.name = "moved-voxel-light",
     .invariant = "moved by what floats hold exactly, voxels' light differs by a half float's step",
     .methods = STABILITY_VOXELS,
     .bound = 0.001,
     .unit = "of the brightest",
     .run = run_moved_voxels,
     .variant = 1},
    {.name = "depth",
     .invariant =
         "places found from depth are right from 1 cm to 100 km: a square's light is as it should",
     .methods = STABILITY_NONE,
     .bound = 0.001,
     .unit = "of the light",
     .run = run_depth},
};

const struct stability_table stability_scale = {
    .name = "place",
    .title = "Scale and place",
    .cases = cases,
    .count = sizeof(cases) / sizeof(cases[0]),
};
