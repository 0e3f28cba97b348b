// Geometry without area, direction or finite position, or far too much of it, leaves everything
// else as it is.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "renderer/import/builtin/builtin.h"
#include "renderer/image/image.h"
#include "renderer/metrics/picture.h"
#include "server/tool/stability/stage.h"

// Above the box.
static const float middle[3] = {-0.75f, 1.5f, -0.75f};

typedef void (*add_function)(struct stage *stage);

// Draws the stage with what `add` adds; NULL for nothing.
static bool draw_with(struct stability_run *run, add_function add, struct picture *out_picture)
{
    struct stage stage;
    *out_picture = (struct picture){0};
    if (!add)
        return stage_draw_usual(run, out_picture);
    if (!stage_create(run, &(struct stage_params){0}, &stage))
        return false;
    add(&stage);
    return stage_draw(run, &stage, out_picture);
}

// What `hard` adds must look like what `plain` adds (NULL: nothing), to the last pixel.
static void compare(struct stability_run *run, add_function hard, add_function plain)
{
    struct picture expected, test;
    if (draw_with(run, plain, &expected) && draw_with(run, hard, &test)) {
        stability_compare(run, &test, &expected, "");
        picture_finish(&test);
    }
    picture_finish(&expected);
}

// Replaces pixels by those of `expected` next to which what `hard` adds changes direct light, by
// itself or by its shadow. What is left are the pixels of other objects.
static bool leave_own_pixels_out(struct stability_run *run, add_function hard, add_function plain,
                                 struct picture *test, const struct picture *expected)
{
    struct stability_run direct = {
        .suite = run->suite, .test = run->test, .method = GI_METHOD_NONE};
    struct picture with = {0}, without = {0};
    bool done = draw_with(&direct, hard, &with) && draw_with(&direct, plain, &without);
    run->frames += direct.frames;
    for (uint32_t i = 0; done && with.width > 0 && i < with.width * with.height; i++) {
        uint32_t x = i % with.width, y = i / with.width;
        if (memcmp(with.rgb + 3 * (size_t)i, without.rgb + 3 * (size_t)i, 3 * sizeof(float)) == 0)
            continue;
        for (uint32_t row = y > 0 ? y - 1 : 0; row <= y + 1 && row < with.height; row++)
            for (uint32_t column = x > 0 ? x - 1 : 0; column <= x + 1 && column < with.width;
                 column++) {
                size_t at = 3 * ((size_t)row * with.width + column);
                memcpy(test->rgb + at, expected->rgb + at, 3 * sizeof(float));
            }
    }
    if (!done)
        stability_fail(run, "%s", direct.where);
    picture_finish(&with);
    picture_finish(&without);
    return done;
}

static void compare_others(struct stability_run *run, add_function hard, add_function plain)
{
    struct picture expected = {0}, test = {0};
    if (draw_with(run, plain, &expected) && draw_with(run, hard, &test)) {
        stability_keep(run, &test, "drawn");
        if (leave_own_pixels_out(run, hard, plain, &test, &expected)) {
            uint32_t pixel = 0;
            double difference = stability_difference(&test, &expected, &pixel);
            stability_measure(run, difference, "pixel %u, %u", pixel % test.width,
                              pixel / test.width);
        }
    }
    picture_finish(&expected);
    picture_finish(&test);
}

static void add_zero_area(struct stage *stage)
{
    // A point, a line, and a line there and back.
    struct scene_vertex v[9] = {stage_vertex(0.0f, 0.0f, 0.0f),  stage_vertex(0.0f, 0.0f, 0.0f),
                                stage_vertex(0.0f, 0.0f, 0.0f),  stage_vertex(-0.5f, 0.0f, 0.0f),
                                stage_vertex(0.0f, 0.25f, 0.0f), stage_vertex(0.5f, 0.5f, 0.0f),
                                stage_vertex(0.0f, 0.0f, -0.5f), stage_vertex(0.0f, 0.0f, 0.5f),
                                stage_vertex(0.0f, 0.0f, -0.5f)};
    stage_add_triangles(stage, v, 3, stage->walls, middle);
}

static void run_zero_area(struct stability_run *run)
{
    compare(run, add_zero_area, NULL);
}

static void add_nan_positions(struct stage *stage)
{
    struct scene_vertex v[9];
    for (int i = 0; i < 9; i++)
        v[i] = stage_vertex(0.5f * (float)(i % 3), 0.25f * (float)(i % 2), 0.0f);
    v[0].position[1] = NAN;
    v[4].position[0] = INFINITY;
    v[8].position[2] = -3e38f;
    stage_add_triangles(stage, v, 3, stage->walls, middle);
}

static void run_nan_positions(struct stability_run *run)
{
    compare(run, add_nan_positions, NULL);
}

static void add_slivers(struct stage *stage)
{
    struct scene_vertex v[3 * 16];
    for (int i = 0; i < 16; i++) {
        float y = 0.0625f * (float)i;
        v[3 * i] = stage_vertex(-0.5f, y, 0.0f);
        v[3 * i + 1] = stage_vertex(0.5f, y, 0.0f);
        v[3 * i + 2] = stage_vertex(0.5f, y + 1e-6f, 0.0f);
    }
    stage_add_triangles(stage, v, 16, stage->walls, middle);
}

static void run_slivers(struct stability_run *run)
{
    compare_others(run, add_slivers, NULL);
}

// A sheet that faces the camera and the light, of cells x cells quads, many times over.
static void add_sheet_of(struct stage *stage, float size_m, uint32_t cells, uint32_t copies,
                         void (*change)(struct scene_vertex triangle[3], uint32_t number),
                         uint32_t material)
{
    uint32_t count = 2 * cells * cells * copies;
    struct scene_vertex *v = malloc((size_t)count * 3 * sizeof(*v));
    static const int corners[6][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}};
    for (uint32_t i = 0; v && i < 3 * count; i++) {
        uint32_t cell = i / 6 % (cells * cells);
        float x = (float)(cell % cells) + (float)corners[i % 6][0];
        float y = (float)(cell / cells) + (float)corners[i % 6][1];
        v[i] = stage_vertex(size_m * x / (float)cells, size_m * y / (float)cells, 0.0f);
        memcpy(v[i].normal, (float[3]){0.0f, 0.0f, 1.0f}, sizeof(v[i].normal));
        v[i].uv[0][0] = v[i].position[0];
        v[i].uv[0][1] = v[i].position[1];
        if (change && i % 3 == 2)
            change(v + i - 2, i / 3);
    }
    if (v)
        stage_add_triangles(stage, v, count, material, (const float[3]){-1.0f, 1.0f, 0.0f});
    free(v);
}

static void add_sheet(struct stage *stage, uint32_t cells, uint32_t copies,
                      void (*change)(struct scene_vertex triangle[3], uint32_t number),
                      uint32_t material)
{
    add_sheet_of(stage, 1.0f, cells, copies, change, material);
}

static uint32_t two_sided(struct stage *stage)
{
    uint32_t material =
        builtin_add_matte(stage->scene, "sheet", (const float[3]){0.5f, 0.4f, 0.3f});
    stage->scene->materials[material].double_sided = true;
    return material;
}

static void add_plain_sheet(struct stage *stage)
{
    add_sheet(stage, 8, 1, NULL, two_sided(stage));
}

static void add_duplicates(struct stage *stage)
{
    add_sheet(stage, 8, 100, NULL, two_sided(stage));
}

static void run_duplicates(struct stability_run *run)
{
    compare(run, add_duplicates, add_plain_sheet);
}

static void add_coincident(struct stage *stage)
{
    uint32_t material = two_sided(stage);
    add_sheet(stage, 8, 1, NULL, material);
    add_sheet(stage, 5, 1, NULL, material);
}

static void run_coincident(struct stability_run *run)
{
    compare(run, add_coincident, add_plain_sheet);
}

// Every other triangle is wound the other way, and its normals point away.
static void flip(struct scene_vertex triangle[3], uint32_t number)
{
    if (number % 2 == 0)
        return;
    struct scene_vertex kept = triangle[1];
    triangle[1] = triangle[2];
    triangle[2] = kept;
    for (int i = 0; i < 3; i++)
        triangle[i].normal[2] = -1.0f;
}

static void add_flipped(struct stage *stage)
{
    add_sheet(stage, 8, 1, flip, two_sided(stage));
}

static void run_flipped(struct stability_run *run)
{
    compare(run, add_flipped, add_plain_sheet);
}

static void drop_normals(struct scene_vertex triangle[3], uint32_t number)
{
    for (int i = 0; i < 3; i++) {
        float value = number % 3 == 0 ? 0.0f : number % 3 == 1 ? NAN : INFINITY;
        for (int axis = 0; axis < 3; axis++) {
            triangle[i].normal[axis] = value;
            triangle[i].tangent[axis] = value;
        }
    }
}

static void add_without_normals(struct stage *stage)
{
    add_sheet(stage, 8, 1, drop_normals, two_sided(stage));
}

static void run_without_normals(struct stability_run *run)
{
    compare(run, add_without_normals, add_plain_sheet);
}

static void tell_count(struct stability_run *run, const struct frame_statistics *statistics,
                       const char *name, uint64_t expected)
{
    for (uint32_t i = 0; i < statistics->reject_count; i++)
        if (strcmp(statistics->rejects[i].name, name) == 0)
            stability_measure(run, fabs((double)statistics->rejects[i].count - (double)expected),
                              "%s: %llu rather than %llu", name,
                              (unsigned long long)statistics->rejects[i].count,
                              (unsigned long long)expected);
}

// Three triangles at no finite position. Of 18 triangles every third has normals of NaN, every
// third infinite ones.
static void run_counted(struct stability_run *run)
{
    struct stage stage;
    struct stability_view view;
    struct frame_statistics statistics;
    if (!stage_create(run, &(struct stage_params){0}, &stage))
        return;
    add_nan_positions(&stage);
    add_sheet(&stage, 3, 1, drop_normals, stage.walls);
    struct frame_params params = stability_params(run);
    params.camera = stage.camera;
    if (stability_view_open(&view, run, stage.scene) &&
        stability_view_draw(&view, &params) == RENDER_DRAWN) {
        renderer_view_get_statistics(stability_renderer(run), view.view, &statistics);
        tell_count(run, &statistics, "triangles_left_out", 3);
        tell_count(run, &statistics, "vertices_mended", 36);
        tell_count(run, &statistics, "voxel_values_cut", 0);
        tell_count(run, &statistics, "lights_without_shadow", 0);
    }
    stability_view_close(&view);
    scene_destroy(&stage.scene);
}

static void drop_uv(struct scene_vertex triangle[3], uint32_t number)
{
    (void)number;
    for (int i = 0; i < 3; i++) {
        memset(triangle[i].uv, 0, sizeof(triangle[i].uv));
        memset(triangle[i].tangent, 0, sizeof(triangle[i].tangent));
    }
}

// An image of one colour, and a flat normal map.
static uint32_t textured(struct stage *stage)
{
    uint32_t material = two_sided(stage);
    struct scene_material *it = &stage->scene->materials[material];
    for (int slot = 0; slot < 2; slot++) {
        uint8_t *texels = malloc(16);
        for (int i = 0; texels && i < 16; i++)
            texels[i] = i % 4 == 3 ? 255 : slot == 0 ? 188 : i % 4 == 2 ? 255 : 128;
        struct image *image = texels ? image_create(2, 2, texels) : NULL;
        if (!image) {
            free(texels);
            continue;
        }
        it->textures[slot == 0 ? SCENE_TEXTURE_BASE_COLOR : SCENE_TEXTURE_NORMAL].image =
            scene_add_image(stage->scene, image);
        image_release(&image);
    }
    return material;
}

static void add_textured(struct stage *stage)
{
    add_sheet(stage, 8, 1, NULL, textured(stage));
}

static void add_without_uv(struct stage *stage)
{
    add_sheet(stage, 8, 1, drop_uv, textured(stage));
}

static void run_without_uv(struct stability_run *run)
{
    compare(run, add_without_uv, add_textured);
}

// Balls so small that a voxel holds all of one, so that its normals cancel.
static void add_cancelling(struct stage *stage)
{
    struct mesh_builder builder;
    mesh_builder_init(&builder);
    for (int i = 0; i < 4; i++)
        mesh_builder_add_sphere(&builder, (const float[3]){0.25f * (float)i, 0.0f, 0.0f}, 0.005f,
                                12, 8);
    stage_add(stage, &builder, stage->walls, middle);
}

static void run_cancelling(struct stability_run *run)
{
    compare_others(run, add_cancelling, NULL);
}

// A closed card, a millionth of a metre thick: opposite faces cancel in every voxel.
static void add_card(struct stage *stage)
{
    struct mesh_builder builder;
    mesh_builder_init(&builder);
    mesh_builder_add_box(&builder, (const float[3]){0.0f, 0.0f, -5e-7f},
                         (const float[3]){1.0f, 1.0f, 5e-7f}, BOX_ALL);
    stage_add(stage, &builder, two_sided(stage), (const float[3]){-1.0f, 1.0f, 0.0f});
}

static void run_card(struct stability_run *run)
{
    compare(run, add_card, add_plain_sheet);
}

// At least as many fragments in each voxel as there are copies.
#define FRAGMENT_CELLS  2u
#define FRAGMENT_COPIES 12000u

// A sheet in red, then one in blue, by vertex colours.
static void color_in_turns(struct scene_vertex triangle[3], uint32_t number)
{
    bool red = number / (2 * FRAGMENT_CELLS * FRAGMENT_CELLS) % 2 == 0;
    for (int i = 0; i < 3; i++) {
        triangle[i].color[0] = red ? 1.0f : 0.2f;
        triangle[i].color[1] = 0.0f;
        triangle[i].color[2] = red ? 0.2f : 1.0f;
    }
}

static void color_by_mean(struct scene_vertex triangle[3], uint32_t number)
{
    (void)number;
    for (int i = 0; i < 3; i++) {
        triangle[i].color[0] = triangle[i].color[2] = 0.6f;
        triangle[i].color[1] = 0.0f;
    }
}

static void add_many_fragments(struct stage *stage)
{
    add_sheet_of(stage, 0.25f, FRAGMENT_CELLS, FRAGMENT_COPIES, color_in_turns, two_sided(stage));
}

static void add_mean_sheet(struct stage *stage)
{
    add_sheet_of(stage, 0.25f, FRAGMENT_CELLS, 1, color_by_mean, two_sided(stage));
}

// The albedo of voxels, as the debug view shows it: the mean of all surfaces in them.
static void run_many_fragments(struct stability_run *run)
{
    struct picture pictures[2] = {{0}, {0}};
    for (int i = 0; i < 2; i++) {
        struct stage stage;
        if (!stage_create(run, &(struct stage_params){.no_objects = true}, &stage))
            break;
        (i == 0 ? add_mean_sheet : add_many_fragments)(&stage);
        struct frame_params params = stability_params(run);
        params.camera = stage.camera;
        params.settings.shadows = false; // 24,000 sheets would be drawn into each map
        params.debug_view = DEBUG_VIEW_VOXEL_ALBEDO;
        params.debug_face = VOXEL_FACE_POSITIVE_Z;
        stability_draw(run, stage.scene, &params, &pictures[i]);
        scene_destroy(&stage.scene);
    }
    if (pictures[0].rgb && pictures[1].rgb)
        stability_compare(run, &pictures[1], &pictures[0], "");
    picture_finish(&pictures[0]);
    picture_finish(&pictures[1]);
}

// A triangle as long as a million voxels of the room, far below it.
static void add_giant(struct stage *stage)
{
    const float reach = 31250.0f;
    struct scene_vertex v[3] = {stage_vertex(-reach, 0.0f, reach), stage_vertex(reach, 0.0f, reach),
                                stage_vertex(0.0f, 0.0f, -reach)};
    stage_add_triangles(stage, v, 1, stage->walls, (const float[3]){0.0f, -100.0f, 0.0f});
}

static void run_giant(struct stability_run *run)
{
    compare(run, add_giant, NULL);
}

// Voxels become coarser, so that indirect light may be lost; but none is added.
static void run_giant_voxels(struct stability_run *run)
{
    struct stability_run direct = {
        .suite = run->suite, .test = run->test, .method = GI_METHOD_NONE};
    struct picture minimum = {0}, maximum = {0}, test = {0};
    if (draw_with(&direct, NULL, &minimum) && draw_with(run, NULL, &maximum) &&
        draw_with(run, add_giant, &test)) {
        double low = stability_mean(&minimum), high = stability_mean(&maximum);
        double mean = stability_mean(&test);
        stability_measure(run, fmax(low - mean, mean - high) / high,
                          "mean %.4g, without %.4g, direct %.4g", mean, high, low);
        stability_keep(run, &test, "drawn");
    }
    picture_finish(&minimum);
    picture_finish(&maximum);
    picture_finish(&test);
}

// 707^2 x 2 triangles in a patch of 4 cm, which one voxel of 6 cm holds.
static void add_patch(struct stage *stage, uint32_t cells)
{
    uint32_t edge = cells + 1;
    struct scene_vertex *v = malloc((size_t)edge * edge * sizeof(*v));
    uint32_t *indices = malloc((size_t)cells * cells * 6 * sizeof(*indices));
    for (uint32_t i = 0; v && i < edge * edge; i++) {
        v[i] = stage_vertex(0.04f * (float)(i % edge) / (float)cells,
                            0.04f * (float)(i / edge) / (float)cells, 0.0f);
        memcpy(v[i].normal, (float[3]){0.0f, 0.0f, 1.0f}, sizeof(v[i].normal));
    }
    for (uint32_t i = 0; indices && i < cells * cells; i++) {
        uint32_t corner = i / cells * edge + i % cells;
        const uint32_t quad[6] = {corner, corner + 1,        corner + edge + 1,
                                  corner, corner + edge + 1, corner + edge};
        memcpy(indices + (size_t)6 * i, quad, sizeof(quad));
    }
    struct scene *scene = stage->scene;
    uint32_t material = two_sided(stage);
    uint32_t mesh = scene_add_mesh(scene, "patch");
    if (v && indices)
        scene_add_primitive(scene, v, edge * edge, indices, cells * cells * 6, material);
    uint32_t node = builtin_add_mesh_node(scene, "patch", mesh);
    if (node != SCENE_NONE)
        stage_to_world(stage, (const float[3]){-0.5f, 1.25f, 0.5f}, scene->nodes[node].translation);
    scene_update_world_transforms(scene);
    free(v);
    free(indices);
}

static void add_million(struct stage *stage)
{
    add_patch(stage, 708);
}

static void add_one_quad(struct stage *stage)
{
    add_patch(stage, 1);
}

static void run_million(struct stability_run *run)
{
    compare(run, add_million, add_one_quad);
}

#define OF_BRIGHTEST "of the brightest"

static const struct stability_case cases[] = {
    {.name = "zero-area",
     .invariant = "triangles that are points or lines change no pixel",
     .methods = STABILITY_ALL,
     .bound = 0.0,
     .unit = OF_BRIGHTEST,
     .run = run_zero_area},
    {.name = "slivers",
     .invariant = "triangles 1 m long and 1 um wide change no pixel but those they are in",
     .methods = STABILITY_ALL,
     .bound = 0.004,
     .unit = OF_BRIGHTEST,
     .run = run_slivers},
    {.name = "duplicates",
     .invariant = "a sheet of triangles that are there 100 times looks as if they were there once",
     .methods = STABILITY_ALL,
     .bound = 0.0,
     .voxel_bound = 0.0005,
     .unit = OF_BRIGHTEST,
     .run = run_duplicates},
    {.name = "coincident",
     .invariant = "two sheets in one place, cut otherwise, look as one",
     .methods = STABILITY_ALL,
     .bound = 0.004,
     .unit = OF_BRIGHTEST,
     .run = run_coincident},
    {.name = "flipped",
     .invariant = "a two-sided sheet looks the same if every other triangle is turned around",
     .methods = STABILITY_ALL,
     .bound = 0.004,
     .unit = OF_BRIGHTEST,
     .run = run_flipped},
    {.name = "no-normals",
     .invariant = "normals and tangents of 0, NaN or infinity leave the triangle's own",
     .methods = STABILITY_ALL,
     .bound = 0.004,
     .unit = OF_BRIGHTEST,
     .run = run_without_normals},
    {.name = "no-uv",
     .invariant = "even textures look the same without texture coordinates and tangents",
     .methods = STABILITY_ALL,
     .bound = 0.01,
     .unit = OF_BRIGHTEST,
     .run = run_without_uv},
    {.name = "nan-positions",
     .invariant = "triangles with a corner at NaN or infinity are left out and change no pixel",
     .methods = STABILITY_ALL,
     .bound = 0.0,
     .unit = OF_BRIGHTEST,
     .run = run_nan_positions},
    {.name = "counted",
     .invariant = "the statistics tell how many triangles were left out and vertices repaired",
     .methods = STABILITY_NONE,
     .bound = 0.0,
     .unit = "miscounted",
     .run = run_counted},
    {.name = "cancelling-balls",
     .invariant = "balls of 1 cm, whose normals cancel in a voxel, change no other pixel",
     .methods = STABILITY_DRAWN,
     .bound = 0.004,
     .unit = OF_BRIGHTEST,
     .run = run_cancelling},
    {.name = "cancelling-card",
     .invariant = "a card 1 um thick looks as a two-sided sheet",
     .methods = STABILITY_ALL,
     .bound = 0.004,
     .unit = OF_BRIGHTEST,
     .run = run_card},
    {.name = "many-fragments",
     .invariant = "voxels that more than 10,000 triangles cross hold the mean of their colours",
     .methods = STABILITY_VOXELS,
     .bound = 0.001,
     .unit = OF_BRIGHTEST,
     .run = run_many_fragments},
    {.name = "giant-triangle",
     .invariant = "a triangle as long as a million voxels, out of sight, changes no pixel (the "
                  "reference: but by chance)",
     .methods = STABILITY_NONE | STABILITY_REFERENCE,
     .bound = 0.01,
     .unit = OF_BRIGHTEST,
     .run = run_giant},
    {.name = "giant-triangle-voxels",
     .invariant =
         "the same where it makes voxels 500 m wide: indirect light is lost, none is added",
     .methods = STABILITY_VOXELS,
     .bound = 0.01,
     .unit = "of the mean",
     .run = run_giant_voxels},
    {.name = "million-in-a-voxel",
     .invariant = "a million triangles in one voxel look as two of the same outline",
     .methods = STABILITY_ALL,
     .bound = 0.004,
     .voxel_bound = 0.05, // each counts as 1/512 of a voxel's face, so that they cover it all
     .unit = OF_BRIGHTEST,
     .run = run_million},
};

const struct stability_table stability_geometry = {
    .name = "geometry",
    .title = "Geometry",
    .cases = cases,
    .count = sizeof(cases) / sizeof(cases[0]),
};
