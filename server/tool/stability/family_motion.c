// Motion leaves nothing behind, and what does not move does not flicker.
// (tests/gpu/test_voxel_walks.c compares voxels filled step by step with voxels filled at once,
// over walks of hundreds of steps.)
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "renderer/metrics/display.h"
#include "renderer/metrics/picture.h"
#include "server/tool/stability/stage.h"

#define WALK_STEPS  24
#define SLIDE_STEPS 32

static uint32_t next_random(uint64_t *state)
{
    *state = *state * 6364136223846793005ull + 1442695040888963407ull;
    return (uint32_t)(*state >> 33);
}

// Moves the box and the glowing ball to a position on the floor.
static void add_objects(struct stage *stage, uint64_t *state)
{
    static const float whole[3] = {1.0f, 1.0f, 1.0f};
    for (int i = 0; i < 2; i++) {
        float x = -1.25f + 2.5f * (float)(next_random(state) % 1000) / 1000.0f;
        float z = -1.25f + 2.0f * (float)(next_random(state) % 1000) / 1000.0f;
        float turn = (float)(next_random(state) % 628) / 100.0f;
        scene_set_node_transform(stage->scene, i == 0 ? stage->box : stage->ball,
                                 (const float[3]){x, i == 0 ? 0.0f : 0.75f, z},
                                 (const float[4]){0.0f, sinf(0.5f * turn), 0.0f, cosf(0.5f * turn)},
                                 whole);
    }
}

static bool create_glowing(struct stability_run *run, struct stage *stage)
{
    if (!stage_create(run, &(struct stage_params){0}, stage))
        return false;
    uint32_t mesh = stage->scene->nodes[stage->ball].mesh;
    uint32_t material =
        stage->scene->primitives[stage->scene->meshes[mesh].primitive_first].material;
    struct scene_material *ball = &stage->scene->materials[material];
    for (int c = 0; c < 3; c++)
        ball->emissive[c] = c == 0 ? 1.0f : 0.5f;
    ball->emissive_strength = 5.0f;
    return true;
}

// Many steps with a frame each, then frames until it has converged; or the last step alone.
static bool draw_walk(struct stability_run *run, bool walks, struct picture *out_picture)
{
    struct stage stage;
    struct stability_view view;
    *out_picture = (struct picture){0};
    if (!create_glowing(run, &stage))
        return false;
    struct frame_params params = stability_params(run);
    params.camera = stage.camera;
    bool done = !walks || stability_view_open(&view, run, stage.scene);
    uint64_t state = 5;
    for (int step = 0; step < WALK_STEPS && done; step++) {
        add_objects(&stage, &state);
        done = !walks || stability_view_draw(&view, &params) == RENDER_DRAWN;
    }
    if (!walks)
        done = stability_draw(run, stage.scene, &params, out_picture);
    else if (done && stability_view_settle(&view, &params)) {
        *out_picture = view.picture;
        view.picture = (struct picture){0};
    }
    if (walks)
        stability_view_close(&view);
    scene_destroy(&stage.scene);
    return done;
}

static void run_walk(struct stability_run *run)
{
    struct picture fresh, walked;
    if (!draw_walk(run, false, &fresh))
        return;
    if (draw_walk(run, true, &walked)) {
        uint32_t pixel = 0;
        double difference = stability_difference(&walked, &fresh, &pixel);
        stability_measure(run, difference, "pixel %u, %u; %llu channels changed",
                          pixel % fresh.width, pixel / fresh.width,
                          (unsigned long long)stability_count_changed(&walked, &fresh));
        stability_keep(run, &fresh, "fresh");
        stability_keep(run, &walked, "walked");
        picture_finish(&walked);
    }
    picture_finish(&fresh);
}

static int compare_doubles(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

// Differences of displayed values between frames of a camera that slides along a wall by one pixel
// a step, so that each surface point is in the centre of a pixel in every frame. In 1/255.
static size_t add_changes(const struct display_params *display, const struct picture *before,
                          const struct picture *after, double *changes)
{
    size_t count = 0;
    for (uint32_t y = 0; y < after->height; y++)
        for (uint32_t x = 0; x + 1 < after->width; x++) {
            float a[3], b[3];
            display_pixel(display, after->rgb + 3 * ((size_t)y * after->width + x), a);
            display_pixel(display, before->rgb + 3 * ((size_t)y * after->width + x + 1), b);
            double change = 0.0;
            for (int c = 0; c < 3; c++)
                change = fmax(change, 255.0 * fabs((double)a[c] - (double)b[c]));
            changes[count++] = change;
        }
    return count;
}

// `variant` is the quantile in percent.
static void run_slide(struct stability_run *run)
{
    struct stage stage;
    struct stability_view view;
    struct picture before = {0};
    if (!stage_create(run, &(struct stage_params){.no_objects = true}, &stage))
        return;
    struct frame_params params = stability_params(run);
    const float distance = 3.5f, wall = -2.0f;
    params.camera.fov_y_rad = 0.3f;
    float pixel_m = 2.0f * distance * tanf(0.5f * params.camera.fov_y_rad) / (float)params.height;
    size_t maximum = (size_t)params.width * params.height * SLIDE_STEPS, count = 0;
    double *changes = malloc(maximum * sizeof(*changes));
    struct display_params display = {.tonemap = TONEMAP_HABLE};
    bool done = changes && stability_view_open(&view, run, stage.scene);
    for (int step = 0; step <= SLIDE_STEPS && done; step++) {
        float x = -0.4f + pixel_m * (float)step;
        memcpy(params.camera.eye, (float[3]){x, 1.4f, wall + distance}, sizeof(params.camera.eye));
        memcpy(params.camera.target, (float[3]){x, 1.4f, wall}, sizeof(params.camera.target));
        if (step == 0)
            done = stability_view_settle(&view, &params);
        else
            done = stability_view_draw(&view, &params) == RENDER_DRAWN;
        if (step == 0 && done)
            display.exposure = display_automatic_exposure(&view.picture);
        else if (done)
            count += add_changes(&display, &before, &view.picture, changes + count);
        picture_finish(&before);
        before = view.picture;
        view.picture = (struct picture){0};
    }
    if (done) {
        qsort(changes, count, sizeof(*changes), compare_doubles);
        stability_measure(run, changes[count * (size_t)run->test->variant / 100],
                          "%.3f m a step; most %.3g", (double)pixel_m, changes[count - 1]);
    }
    picture_finish(&before);
    free(changes);
    stability_view_close(&view);
    scene_destroy(&stage.scene);
}

static const struct stability_case cases[] = {
    {.name = "motion-ghosts",
     .invariant =
         "a glowing ball and a box that have moved 24 times leave no light where they were",
     .methods = STABILITY_DRAWN,
     .bound = 0.0,
     .unit = "of the brightest",
     .run = run_walk},
    {.name = "motion-slide-median",
     .invariant =
         "while the camera slides by parts of voxels, lit points keep their value (median)",
     .methods = STABILITY_DRAWN,
     .bound = 0.2, // measured: 0.0982
     .unit = "1/255",
     .run = run_slide,
     .variant = 50},
    {.name = "motion-slide-p99",
     .invariant = "the same of 99 % of all points, over the snaps of clip levels",
     .methods = STABILITY_DRAWN,
     .bound = 0.62, // measured: 0.31
     .unit = "1/255",
     .run = run_slide,
     .variant = 99},
};

const struct stability_table stability_motion = {
    .name = "motion",
    .title = "Motion",
    .cases = cases,
    .count = sizeof(cases) / sizeof(cases[0]),
};
