// Lights of every intensity, everywhere.
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "renderer/metrics/picture.h"
#include "server/document/document.h"
#include "server/document/document_text.h"
#include "server/tool/stability/stage.h"

static void scale_picture(struct picture *picture, double factor)
{
    for (size_t i = 0; i < 3 * picture_pixel_count(picture); i++)
        picture->rgb[i] = (float)(picture->rgb[i] * factor);
}

static void run_intensities(struct stability_run *run)
{
    static const double strengths[] = {1e-6, 1e-3, 1e4, 1e9};
    struct stage stage;
    struct picture expected;
    if (!stage_create(run, &(struct stage_params){.light_cd = 1.0f}, &stage) ||
        !stage_draw(run, &stage, &expected))
        return;
    for (size_t i = 0; i < sizeof(strengths) / sizeof(strengths[0]); i++) {
        struct picture test;
        char name[32];
        snprintf(name, sizeof(name), "%g cd", strengths[i]);
        if (!stage_create(run, &(struct stage_params){.light_cd = (float)strengths[i]}, &stage) ||
            !stage_draw(run, &stage, &test))
            break;
        scale_picture(&test, 1.0 / strengths[i]);
        stability_compare(run, &test, &expected, name);
        picture_finish(&test);
    }
    picture_finish(&expected);
}

// Edits that must be refused.
static void run_refused(struct stability_run *run)
{
    static const char *const values[] = {"-1", "-1e-30", "nan", "-nan", "inf", "-inf", "1e39", "x"};
    struct stage stage;
    if (!stage_create(run, &(struct stage_params){0}, &stage))
        return;
    uint32_t taken = 0;
    struct render_settings settings;
    struct view_options view = {0};
    render_settings_init(&settings);
    float before = stage.scene->lights[stage.light].intensity;
    for (size_t i = 0; i < sizeof(values) / sizeof(values[0]); i++) {
        struct error error = {""};
        bool done = document_set_text(stage.scene, &settings, &view, "lights.0.intensity",
                                      values[i], &error);
        float after = stage.scene->lights[stage.light].intensity;
        taken += done || memcmp(&after, &before, sizeof(after)) != 0 || error.message[0] == '\0';
        stability_measure(run, taken, "lights.0.intensity=%s", values[i]);
    }
    scene_destroy(&stage.scene);
}

// A light that a program set to an invalid intensity gives no light, and no NaN.
static void run_no_intensity(struct stability_run *run)
{
    static const float values[] = {NAN, -1.0f, INFINITY, -INFINITY};
    for (size_t i = 0; i < sizeof(values) / sizeof(values[0]); i++) {
        struct stage stage;
        struct picture picture;
        if (!stage_create(run, &(struct stage_params){0}, &stage))
            return;
        stage.scene->lights[stage.light].intensity = values[i];
        if (!stage_draw(run, &stage, &picture))
            return;
        stability_measure(run, stability_mean(&picture), "intensity %g", (double)values[i]);
        picture_finish(&picture);
    }
}

static void move_light(struct stage *stage, const float position[3])
{
    scene_set_light_placement(stage->scene, stage->light, position,
                              (const float[3]){0.0f, -1.0f, 0.0f});
}

static void run_positions(struct stability_run *run)
{
    static const struct {
        const char *name;
        float position[3];
    } light_positions[] = {
        {"on-the-floor", {0.25f, 0.0f, 0.75f}},
        {"in-a-corner", {-2.0f, 0.0f, -2.0f}},
        {"in-a-voxel-s-middle", {0.03125f, 1.53125f, 0.03125f}},
        {"at-the-camera", {0.0f, 1.5f, 1.75f}},
        {"on-the-box", {-0.75f, 1.0f, -0.75f}},
    };
    struct stage stage;
    struct stability_view view;
    bool reference = run->method == GI_METHOD_REFERENCE;
    if (!stage_create(run, &(struct stage_params){0}, &stage))
        return;
    struct frame_params params = stability_params(run);
    params.camera = stage.camera;
    bool done = reference || stability_view_open(&view, run, stage.scene);
    for (size_t i = 0; i < sizeof(light_positions) / sizeof(light_positions[0]) && done; i++) {
        struct picture picture = {0};
        move_light(&stage, light_positions[i].position);
        done = reference ? stability_draw(run, stage.scene, &params, &picture)
                         : stability_view_settle(&view, &params);
        if (!done)
            break;
        stability_measure(run, (double)run->bad_values, "%s", light_positions[i].name);
        stability_keep(run, reference ? &picture : &view.picture, light_positions[i].name);
        picture_finish(&picture);
    }
    if (!reference)
        stability_view_close(&view);
    scene_destroy(&stage.scene);
}

// A light in the closed box lights nothing of the room.
static void run_in_solid(struct stability_run *run)
{
    struct stage stage;
    struct picture lit, hidden;
    if (!stage_draw_usual(run, &lit))
        return;
    if (stage_create(run, &(struct stage_params){0}, &stage)) {
        move_light(&stage, (const float[3]){-0.75f, 0.5f, -0.75f});
        if (stage_draw(run, &stage, &hidden)) {
            stability_measure(run, stability_mean(&hidden) / stability_mean(&lit), "mean");
            stability_keep(run, &hidden, "hidden");
            picture_finish(&hidden);
        }
    }
    picture_finish(&lit);
}

static bool draw_spot(struct stability_run *run, enum scene_light_type type, float cone_rad,
                      struct picture *out_picture)
{
    struct stage stage;
    if (!stage_create(run, &(struct stage_params){.no_objects = true}, &stage))
        return false;
    // Under the ceiling, so that a cone of half a turn covers all but the ceiling.
    move_light(&stage, (const float[3]){0.0f, 2.9375f, 0.0f});
    struct scene_light *light = &stage.scene->lights[stage.light];
    light->type = type;
    light->inner_cone_rad = light->outer_cone_rad = cone_rad;
    stage.camera.target[1] = 0.0f;
    stage.camera.fov_y_rad = 1.0f;
    return stage_draw(run, &stage, out_picture);
}

// Direct light only: the light that the ceiling reflects differs between the two.
static void run_wide_spot(struct stability_run *run)
{
    struct picture point, spot;
    if (!draw_spot(run, SCENE_LIGHT_POINT, 0.0f, &point))
        return;
    if (draw_spot(run, SCENE_LIGHT_SPOT, 1.57079633f, &spot)) {
        stability_compare(run, &spot, &point, "spot of 180 degrees");
        picture_finish(&spot);
    }
    picture_finish(&point);
}

static void run_closed_spot(struct stability_run *run)
{
    struct picture point, spot;
    if (!draw_spot(run, SCENE_LIGHT_POINT, 0.0f, &point))
        return;
    if (draw_spot(run, SCENE_LIGHT_SPOT, 0.0f, &spot)) {
        stability_measure(run, stability_mean(&spot) / stability_mean(&point), "mean");
        picture_finish(&spot);
    }
    picture_finish(&point);
}

#define MANY_LIGHTS 1000u

static bool draw_many(struct stability_run *run, uint32_t count, struct picture *out_picture)
{
    struct stage stage;
    if (!stage_create(run, &(struct stage_params){.no_objects = true, .no_light = true}, &stage))
        return false;
    struct scene_light light;
    scene_light_init(&light, SCENE_LIGHT_POINT, "lamp");
    light.intensity = 30.0f / (float)count;
    for (uint32_t i = 0; i < count; i++)
        scene_add_light(stage.scene, &light, (const float[3]){0.5f, 2.25f, 0.5f},
                        (const float[3]){0.0f, -1.0f, 0.0f});
    scene_update_world_transforms(stage.scene);
    return stage_draw(run, &stage, out_picture);
}

static void run_thousand(struct stability_run *run)
{
    struct picture one, many;
    if (!draw_many(run, 1, &one))
        return;
    if (draw_many(run, MANY_LIGHTS, &many)) {
        stability_compare(run, &many, &one, "1000 lights");
        picture_finish(&many);
    }
    picture_finish(&one);
}

static void run_none(struct stability_run *run)
{
    struct stage stage;
    struct picture picture;
    if (!stage_create(run, &(struct stage_params){.no_light = true}, &stage) ||
        !stage_draw(run, &stage, &picture))
        return;
    for (size_t i = 0; i < 3 * picture_pixel_count(&picture); i++)
        stability_measure(run, (double)picture.rgb[i], "value %zu", i);
    picture_finish(&picture);
}

#define OF_BRIGHTEST "of the brightest"

static const struct stability_case cases[] = {
    {.name = "light-intensities",
     .invariant = "lights of 1e-6 to 1e9 cd give images that differ by that factor alone",
     .methods = STABILITY_ALL,
     .bound = 0.0001,
     .voxel_bound = 0.005,
     .unit = OF_BRIGHTEST,
     .run = run_intensities},
    {.name = "light-refused",
     .invariant = "negative, infinite and NaN intensities are refused with a message",
     .methods = STABILITY_NONE,
     .bound = 0.0,
     .unit = "values taken",
     .run = run_refused},
    {.name = "light-no-intensity",
     .invariant = "lights whose intensity is NaN, negative or infinite give no light",
     .methods = STABILITY_ALL,
     .bound = 0.0,
     .unit = "cd/m^2",
     .run = run_no_intensity},
    {.name = "light-places",
     .invariant = "lights on surfaces, in corners, in the middle of a voxel, at the camera: finite",
     .methods = STABILITY_ALL,
     .bound = 0.0,
     .unit = "values not finite",
     .run = run_positions},
    {.name = "light-in-solid",
     .invariant = "a light in a closed box leaves the room dark",
     .methods = STABILITY_ALL,
     .bound = 0.0,
     .voxel_bound = 0.001,
     .unit = "of the lit room",
     .run = run_in_solid},
    {.name = "light-spot-180",
     .invariant = "a spot of 180 degrees lights what is before it as a point does",
     .methods = STABILITY_NONE,
     .bound = 0.005,
     .unit = OF_BRIGHTEST,
     .run = run_wide_spot},
    {.name = "light-spot-0",
     .invariant = "a spot of no width gives no light",
     .methods = STABILITY_ALL,
     .bound = 0.0,
     .unit = "of a point's",
     .run = run_closed_spot},
    {.name = "light-thousand",
     .invariant = "a thousand lights at one position look as one of their sum",
     .methods = STABILITY_NONE | STABILITY_CLIPMAP | STABILITY_REFERENCE,
     .bound = 0.01,
     .unit = OF_BRIGHTEST,
     .run = run_thousand},
    {.name = "light-none",
     .invariant = "without any light the image is black",
     .methods = STABILITY_ALL,
     .bound = 0.0,
     .unit = "cd/m^2",
     .run = run_none},
};

const struct stability_table stability_light = {
    .name = "light",
    .title = "Light",
    .cases = cases,
    .count = sizeof(cases) / sizeof(cases[0]),
};
