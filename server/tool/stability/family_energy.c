// Light is neither created nor lost. (tests/gpu/test_gi_furnace.c has furnaces with every gather
// mode, resolution and step.)
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "renderer/import/builtin/builtin.h"
#include "renderer/metrics/picture.h"
#include "server/tool/stability/stage.h"

#define EMISSION 2.0

// Walls of the furnace.
enum { SOLID, THIN, THIN_PIXELS };

// A closed cube of 2.6 m seen from inside, with equal walls.
static bool create_box(struct stability_run *run, float albedo, float emission, struct stage *stage)
{
    *stage = (struct stage){.scene = scene_create("box"), .scale = 1.0, .light = SCENE_NONE};
    if (!stage->scene) {
        stability_fail(run, "out of memory");
        return false;
    }
    uint32_t material =
        builtin_add_matte(stage->scene, "wall", (const float[3]){albedo, albedo, albedo});
    struct scene_material *wall = &stage->scene->materials[material];
    for (int c = 0; c < 3; c++)
        wall->emissive[c] = emission > 0.0f ? 1.0f : 0.0f;
    wall->emissive_strength = emission > 0.0f ? emission : 1.0f;
    wall->double_sided = run->test->variant != SOLID;
    struct mesh_builder builder;
    mesh_builder_init(&builder);
    mesh_builder_add_box(&builder, (const float[3]){-1.3f, -1.3f, -1.3f},
                         (const float[3]){1.3f, 1.3f, 1.3f}, BOX_ALL);
    // Turned inside out.
    for (uint32_t i = 0; i < builder.mesh.index_count; i += 3) {
        uint32_t kept = builder.mesh.indices[i];
        builder.mesh.indices[i] = builder.mesh.indices[i + 1];
        builder.mesh.indices[i + 1] = kept;
    }
    for (uint32_t i = 0; i < builder.mesh.vertex_count; i++)
        for (int axis = 0; axis < 3; axis++)
            builder.mesh.vertices[i].normal[axis] *= -1.0f;
    stage_add(stage, &builder, material, (const float[3]){0.0f, 0.0f, 0.0f});
    stage->camera = (struct view_camera){.eye = {-0.9f, -0.4f, 0.8f},
                                         .target = {0.8f, 0.25f, -0.6f},
                                         .up = {0.0f, 1.0f, 0.0f},
                                         .fov_y_rad = 1.6f};
    return true;
}

static bool box_mean(struct stability_run *run, float albedo, uint32_t bounces, double *out_mean)
{
    struct stage stage;
    struct picture picture;
    if (!create_box(run, albedo, (float)EMISSION, &stage))
        return false;
    struct frame_params params = stability_params(run);
    params.camera = stage.camera;
    params.settings.bounces = bounces;
    if (run->test->variant == THIN_PIXELS)
        params.settings.gather_mode = GATHER_PIXEL;
    bool done = stability_draw(run, stage.scene, &params, &picture);
    scene_destroy(&stage.scene);
    if (done)
        *out_mean = stability_mean(&picture);
    picture_finish(&picture);
    return done;
}

static void run_furnace(struct stability_run *run)
{
    static const float albedos[] = {0.5f, 0.8f};
    // Thin walls lose most where light bounces most.
    for (size_t i = run->test->variant == SOLID ? 0 : 1; i < sizeof(albedos) / sizeof(albedos[0]);
         i++) {
        double mean, expected = EMISSION / (1.0 - (double)albedos[i]);
        if (!box_mean(run, albedos[i], 0, &mean))
            return;
        stability_measure(run, fabs(mean / expected - 1.0), "albedo %g: %g rather than %g",
                          (double)albedos[i], mean, expected);
    }
}

static void run_bounces(struct stability_run *run)
{
    const double albedo = 0.7;
    double before = 0.0, series = 1.0, power = 1.0;
    for (uint32_t bounces = 1; bounces <= 4; bounces++) {
        double mean;
        if (!box_mean(run, (float)albedo, bounces, &mean))
            return;
        power *= albedo;
        series += power;
        stability_measure(run, fmax(before - mean, mean - EMISSION * series) / (EMISSION * series),
                          "%u bounces: %g, one less %g, sum %g", bounces, mean, before,
                          EMISSION * series);
        before = mean;
    }
}

// Walls that absorb nothing: light grows without end, but values must stay finite.
static void run_white(struct stability_run *run)
{
    double mean;
    if (box_mean(run, 1.0f, 0, &mean))
        stability_measure(run, (double)run->bad_values, "mean %g", mean);
}

#define MAX_DARK_FRAMES 200u

// Frames until half of the light is gone; in the end all of it must go.
static void run_light_out(struct stability_run *run)
{
    struct stage stage;
    struct stability_view view;
    if (!stage_create(run, &(struct stage_params){0}, &stage))
        return;
    struct frame_params params = stability_params(run);
    params.camera = stage.camera;
    params.settings.bounces = 0;
    bool done =
        stability_view_open(&view, run, stage.scene) && stability_view_settle(&view, &params);
    double lit = done ? stability_mean(&view.picture) : 0.0;
    struct scene_light light = stage.scene->lights[stage.light];
    light.enabled = false;
    scene_set_light(stage.scene, stage.light, &light);
    for (uint32_t frame = 1; done && frame <= MAX_DARK_FRAMES; frame++) {
        done = stability_view_draw(&view, &params) == RENDER_DRAWN;
        if (done && stability_mean(&view.picture) > 0.5 * lit)
            continue;
        stability_measure(run, frame, "half dark");
        break;
    }
    if (done && stability_view_settle(&view, &params) && stability_mean(&view.picture) > 0.01 * lit)
        stability_fail(run, "%g of the light stay", stability_mean(&view.picture) / lit);
    stability_view_close(&view);
    scene_destroy(&stage.scene);
}

// A white ball in a uniform white sky: no pixel may be brighter than the sky. `variant` is its
// metallic value.
static void run_specular_rays(struct stability_run *run)
{
    for (int i = 0; i < 5; i++) {
        struct stage stage = {.scene = scene_create("furnace"), .scale = 1.0};
        if (!stage.scene)
            return;
        struct scene_material white;
        scene_material_init(&white, "white");
        white.metallic = (float)run->test->variant;
        white.roughness = 0.25f * (float)i;
        struct mesh_builder builder;
        mesh_builder_init(&builder);
        mesh_builder_add_sphere(&builder, (const float[3]){0.0f, 0.0f, 0.0f}, 1.0f, 64, 48);
        stage_add(&stage, &builder, scene_add_material(stage.scene, &white),
                  (const float[3]){0.0f, 0.0f, 0.0f});
        stage.scene->environment = (struct scene_environment){
            .type = SCENE_ENVIRONMENT_CONSTANT, .intensity = 1.0f, .color = {1.0f, 1.0f, 1.0f}};
        struct frame_params params = stability_params(run);
        params.camera.eye[2] = 2.5f;
        struct picture picture;
        bool done = stability_draw(run, stage.scene, &params, &picture);
        scene_destroy(&stage.scene);
        for (size_t j = 0; done && j < 3 * picture_pixel_count(&picture); j++)
            stability_measure(run, (double)picture.rgb[j] - 1.0, "roughness %g",
                              (double)white.roughness);
        picture_finish(&picture);
    }
}

static bool stage_mean(struct stability_run *run, enum gi_method method, uint32_t bounces,
                       double *out_mean)
{
    struct stability_run one = {.suite = run->suite, .test = run->test, .method = method};
    struct stage stage;
    struct picture picture = {0};
    if (!stage_create(run, &(struct stage_params){0}, &stage))
        return false;
    struct frame_params params = stability_params(&one);
    params.camera = stage.camera;
    params.settings.bounces = bounces;
    bool done = stability_draw(&one, stage.scene, &params, &picture);
    scene_destroy(&stage.scene);
    run->frames += one.frames;
    run->bad_values += one.bad_values;
    if (!done || one.failed)
        stability_fail(run, "%s", one.where);
    *out_mean = done ? stability_mean(&picture) : 0.0;
    picture_finish(&picture);
    return done;
}

// What each bounce adds to the mean of the stage's image, compared with what it adds to the
// reference image.
static void run_ratio(struct stability_run *run)
{
    double before[2], mean[2];
    if (!stage_mean(run, GI_METHOD_NONE, 1, &before[0]))
        return;
    before[1] = before[0]; // direct light counts as equal in both: the other families compare it
    for (uint32_t bounces = 1; bounces <= 3; bounces++) {
        if (!stage_mean(run, run->method, bounces, &mean[0]) ||
            !stage_mean(run, GI_METHOD_REFERENCE, bounces, &mean[1]))
            return;
        double ratio = (mean[0] - before[0]) / (mean[1] - before[1]);
        stability_measure(run, fabs(ratio - 1.0), "bounce %u: %.3f of the reference's", bounces,
                          ratio);
        memcpy(before, mean, sizeof(before));
    }
}

static const struct stability_case cases[] = {
    {.name = "energy-furnace",
     .invariant = "in a closed box that emits L and reflects a everything shows L / (1 - a)",
     .methods = STABILITY_VOXELS,
     .bound = 0.03,
     .unit = "of what is expected",
     .run = run_furnace},
    {.name = "energy-thin-furnace",
     .invariant = "the same where the walls are two-sided and have no thickness",
     .methods = STABILITY_VOXELS,
     .bound = 0.03,
     .unit = "of what is expected",
     .known = 0.05, // slanted cones pick up some of the dark outside at each bounce
     .run = run_furnace,
     .variant = THIN},
    {.name = "energy-thin-pixels",
     .invariant = "the same where each pixel sends cones of its own",
     .methods = STABILITY_VOXELS,
     .bound = 0.03,
     .unit = "of what is expected",
     .known = 0.05, // likewise
     .run = run_furnace,
     .variant = THIN_PIXELS},
    {.name = "energy-bounces",
     .invariant =
         "with each bounce a furnace gets brighter, and no brighter than the geometric sum",
     .methods = STABILITY_VOXELS,
     .bound = 0.01,
     .unit = "of the sum",
     .run = run_bounces},
    {.name = "energy-white",
     .invariant = "a closed box that absorbs nothing stays finite",
     .methods = STABILITY_VOXELS,
     .bound = 0.0,
     .unit = "values not finite",
     .run = run_white},
    {.name = "energy-light-out",
     .invariant =
         "when the light goes out, half of the light is gone within so many frames; then all",
     .methods = STABILITY_VOXELS,
     .bound = 2.0, // measured: 1
     .unit = "frames",
     .run = run_light_out},
    {.name = "energy-metal",
     .invariant = "a white metal in a white sky is no brighter than it, at any roughness and angle",
     .methods = STABILITY_DRAWN,
     .bound = 0.01,
     .unit = "of the sky",
     .run = run_specular_rays,
     .variant = 1},
    {.name = "energy-lacquer",
     .invariant = "the same of a white dielectric",
     .methods = STABILITY_NONE,
     .bound = 0.01,
     .unit = "of the sky",
     // The layer of glTF 2.0 takes from the base what it reflects at the half vector. At grazing
     // view that is far less than all that it reflects.
     .known = 0.9,
     .run = run_specular_rays},
    {.name = "energy-per-bounce",
     .invariant = "each bounce adds to the stage what it adds to the reference image",
     .methods = STABILITY_VOXELS,
     .bound = 0.067, // measured: 0.0339
     .unit = "of the reference's",
     .run = run_ratio},
};

const struct stability_table stability_energy = {
    .name = "energy",
    .title = "Energy",
    .cases = cases,
    .count = sizeof(cases) / sizeof(cases[0]),
};
