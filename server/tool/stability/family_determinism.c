// The same input gives the same output, bit by bit. (tests/gpu/test_voxel_occupancy.c compares
// voxels with a search on the CPU.)
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "renderer/metrics/picture.h"
#include "server/tool/stability/stage.h"

static void compare(struct stability_run *run, const struct picture *test,
                    const struct picture *expected, const char *what)
{
    uint32_t pixel = 0;
    double difference = stability_difference(test, expected, &pixel);
    stability_measure(run, (double)stability_count_changed(test, expected),
                      "%s: %.3g at pixel %u, %u", what, difference, pixel % test->width,
                      pixel / test->width);
}

static bool draw_stage(struct stability_run *run, uint64_t shuffle, struct picture *out_picture);

static void run_twice(struct stability_run *run)
{
    struct picture first, second;
    if (!draw_stage(run, 0, &first))
        return;
    stability_renew(run); // no programs or pools are left
    if (draw_stage(run, 0, &second)) {
        compare(run, &second, &first, "the second run");
        picture_finish(&second);
    }
    picture_finish(&first);
}

// Shuffles the triangles of every primitive.
static void shuffle_triangles(struct scene *scene, uint64_t seed)
{
    for (uint32_t p = 0; p < scene->primitive_count; p++) {
        const struct scene_primitive *primitive = &scene->primitives[p];
        for (uint32_t i = primitive->index_count / 3; i-- > 1;) {
            seed = seed * 6364136223846793005ull + 1442695040888963407ull;
            uint32_t j = (uint32_t)((seed >> 33) % (i + 1)), kept[3];
            uint32_t *a = scene->indices + primitive->index_first + (size_t)3 * i;
            uint32_t *b = scene->indices + primitive->index_first + (size_t)3 * j;
            memcpy(kept, a, sizeof(kept));
            memcpy(a, b, sizeof(kept));
            memcpy(b, kept, sizeof(kept));
        }
    }
}

static bool draw_stage(struct stability_run *run, uint64_t shuffle, struct picture *out_picture)
{
    struct stage stage;
    *out_picture = (struct picture){0};
    if (!stage_create(run, &(struct stage_params){0}, &stage))
        return false;
    if (shuffle > 0)
        shuffle_triangles(stage.scene, shuffle);
    return stage_draw(run, &stage, out_picture);
}

static void run_shuffled(struct stability_run *run)
{
    struct picture plain, shuffled;
    if (!draw_stage(run, 0, &plain))
        return;
    if (draw_stage(run, 17, &shuffled)) {
        uint32_t pixel = 0;
        double difference = stability_difference(&shuffled, &plain, &pixel);
        stability_measure(run, difference, "pixel %u, %u; %llu channels changed",
                          pixel % plain.width, pixel / plain.width,
                          (unsigned long long)stability_count_changed(&shuffled, &plain));
        picture_finish(&shuffled);
    }
    picture_finish(&plain);
}

// The driver reads the number of its threads once per process, so each image needs a process of its
// own.
static bool draw_with_threads(struct stability_run *run, int threads, const char *folder,
                              struct picture *out_picture)
{
    char program[4096], path[4200], command[9000];
    ssize_t length = readlink("/proc/self/exe", program, sizeof(program) - 1);
    program[length > 0 ? length : 0] = '\0';
    snprintf(path, sizeof(path), "%s/%d.pfm", folder, threads);
    snprintf(command, sizeof(command),
             "LP_NUM_THREADS=%d '%s' render builtin:cornell --gi %s --preset interactive "
             "--set bounces=2 --set voxel_resolution=64 --set gather_mode=cache --size 64x48 "
             "--threads %d --spp 4 "
             "--out '%s' >/dev/null",
             threads, program, gi_method_names[run->method], threads, path);
    if (run->method != GI_METHOD_REFERENCE) {
        // Options of the reference alone.
        char *at = strstr(command, "--threads");
        memset(at, ' ', (size_t)(strstr(command, "--out") - at));
    }
    struct error error = {""};
    int status = system(command);
    bool done = status == 0 && picture_read_pfm(path, out_picture, &error);
    if (!done)
        stability_fail(run, "with %d threads: exit status %d %s", threads, WEXITSTATUS(status),
                       error.message);
    remove(path);
    run->frames += done;
    return done;
}

static void run_threads(struct stability_run *run)
{
    char folder[] = "/tmp/voxcast-stability-XXXXXX";
    struct picture one, two;
    if (!mkdtemp(folder)) {
        stability_fail(run, "no folder for images");
        return;
    }
    if (draw_with_threads(run, 1, folder, &one)) {
        if (draw_with_threads(run, 2, folder, &two)) {
            compare(run, &two, &one, "2 threads");
            picture_finish(&two);
        }
        picture_finish(&one);
    }
    rmdir(folder);
}

static void edit(struct stage *stage, int number)
{
    static const float no_turn[4] = {0.0f, 0.0f, 0.0f, 1.0f}, whole[3] = {1.0f, 1.0f, 1.0f};
    struct scene_material walls = stage->scene->materials[stage->walls];
    struct scene_light light = stage->scene->lights[stage->light];
    switch (number) {
    case 0:
        walls.base_color[1] = 0.5f;
        scene_set_material(stage->scene, stage->walls, &walls);
        break;
    case 1:
        scene_set_node_transform(stage->scene, stage->box, (const float[3]){-0.5f, 0.0f, -1.0f},
                                 no_turn, whole);
        break;
    case 2:
        light.intensity *= 1.5f;
        scene_set_light(stage->scene, stage->light, &light);
        break;
    default:
        scene_set_node_transform(stage->scene, stage->ball, (const float[3]){1.0f, 0.75f, 0.0f},
                                 no_turn, whole);
    }
}

// A frame after each edit, then frames until it has converged. `order` < 0: all edits before the
// first frame.
static bool draw_edited(struct stability_run *run, int order, struct picture *out_picture)
{
    static const int orders[2][4] = {{0, 1, 2, 3}, {3, 2, 1, 0}};
    struct stage stage;
    struct stability_view view;
    *out_picture = (struct picture){0};
    if (!stage_create(run, &(struct stage_params){0}, &stage))
        return false;
    struct frame_params params = stability_params(run);
    params.camera = stage.camera;
    bool done = stability_view_open(&view, run, stage.scene);
    if (order >= 0)
        done = done && stability_view_settle(&view, &params);
    for (int i = 0; i < 4 && done; i++) {
        edit(&stage, orders[order > 0][i]);
        done = order < 0 || stability_view_draw(&view, &params) == RENDER_DRAWN;
    }
    done = done && stability_view_settle(&view, &params);
    if (done) {
        *out_picture = view.picture;
        view.picture = (struct picture){0};
    }
    stability_view_close(&view);
    scene_destroy(&stage.scene);
    return done;
}

static void run_edits(struct stability_run *run)
{
    struct picture fresh;
    if (!draw_edited(run, -1, &fresh))
        return;
    for (int order = 0; order < 2; order++) {
        struct picture edited;
        if (!draw_edited(run, order, &edited))
            break;
        compare(run, &edited, &fresh, order == 0 ? "one order" : "the other order");
        picture_finish(&edited);
    }
    picture_finish(&fresh);
}

static const struct stability_case cases[] = {
    {.name = "same-run",
     .invariant = "a renderer that starts afresh draws the same image",
     .methods = STABILITY_ALL,
     .bound = 0.0,
     .unit = "channels changed",
     .run = run_twice},
    {.name = "same-triangle-order",
     .invariant = "the order of triangles does not matter",
     .methods = STABILITY_ALL,
     .bound = 0.0,
     .unit = "of the brightest",
     // The corner at which rasterization of a triangle starts depends on its neighbours, and so
     // does the last digit of depth, from which positions of pixels follow.
     .known = 5e-5,
     .run = run_shuffled},
    {.name = "same-threads",
     .invariant = "1 and 2 threads draw the same image",
     .methods = STABILITY_ALL,
     .bound = 0.0,
     .unit = "channels changed",
     .run = run_threads},
    {.name = "same-edit-order",
     .invariant = "independent edits, in either order or before the first frame, end in one image",
     .methods = STABILITY_DRAWN,
     .bound = 0.0,
     .unit = "channels changed",
     .run = run_edits},
};

const struct stability_table stability_determinism = {
    .name = "determinism",
    .title = "Same input, same output",
    .cases = cases,
    .count = sizeof(cases) / sizeof(cases[0]),
};
