// Materials at the ends of their ranges, and light at the limits of numbers.
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "renderer/image/image.h"
#include "renderer/metrics/picture.h"
#include "server/tool/stability/stage.h"

static uint32_t add_material(struct stage *stage, const struct scene_material *material)
{
    return scene_add_material(stage->scene, material);
}

// Balls in rows before the back wall, one of each material.
static void add_extremes(struct stage *stage)
{
    enum { COUNT = 15 };
    struct scene_material m[COUNT];
    for (int i = 0; i < COUNT; i++) {
        scene_material_init(&m[i], "extreme");
        m[i].metallic = 0.0f;
        m[i].roughness = 0.5f;
    }
    for (int i = 0; i < 4; i++) {
        m[i].roughness = i % 2 ? 1.0f : 0.0f;
        m[i].metallic = i / 2 ? 1.0f : 0.0f;
    }
    m[4].metallic = 0.5f;
    static const float iors[4] = {0.0f, 1.0f, 1.0001f, 3.0f};
    for (int i = 0; i < 4; i++)
        m[5 + i].ior = iors[i];
    memset(m[9].base_color, 0, 3 * sizeof(float));
    m[10].alpha_mode = SCENE_ALPHA_BLEND;
    m[10].base_color[3] = 0.0f;
    m[11].alpha_mode = SCENE_ALPHA_BLEND;
    m[12].transmission = 1.0f;
    m[12].roughness = 0.0f;
    for (int i = 13; i < 15; i++) {
        m[i].transmission = 1.0f;
        m[i].roughness = 0.0f;
        m[i].thickness_m = 0.25f;
        m[i].ior = i == 13 ? 3.0f : 1.0001f;
        m[i].attenuation_distance_m = 0.001f;
        m[i].attenuation_color[1] = 0.0f;
    }
    struct mesh_builder builder;
    mesh_builder_init(&builder);
    for (int i = 0; i < COUNT; i++) {
        mesh_builder_add_sphere(&builder, (const float[3]){0.0f, 0.0f, 0.0f}, 0.25f, 16, 12);
        stage_add(stage, &builder, add_material(stage, &m[i]),
                  (const float[3]){-1.25f + 0.625f * (float)(i % 5), 0.5f + 0.75f * (float)(i / 5),
                                   -0.75f});
    }
}

static void draw_extremes(struct stability_run *run, const float eye[3], const float target[3],
                          const char *name)
{
    struct stage stage;
    struct picture picture;
    if (!stage_create(run, &(struct stage_params){.no_objects = true}, &stage))
        return;
    add_extremes(&stage);
    memcpy(stage.camera.eye, eye, sizeof(stage.camera.eye));
    memcpy(stage.camera.target, target, sizeof(stage.camera.target));
    if (stage_draw(run, &stage, &picture)) {
        stability_measure(run, (double)run->bad_values, "%s", name);
        stability_keep(run, &picture, name);
        picture_finish(&picture);
    }
}

static void run_extremes(struct stability_run *run)
{
    draw_extremes(run, (const float[3]){0.0f, 1.5f, 1.75f}, (const float[3]){0.0f, 1.0f, -0.5f},
                  "balls");
    // Inside the ball of IOR 3, where nearly all light is totally reflected.
    draw_extremes(run, (const float[3]){0.625f, 2.0f, -0.75f}, (const float[3]){1.0f, 1.0f, 1.0f},
                  "inside-glass");
}

// The floor, polished, from 1 mm above.
static void run_grazing(struct stability_run *run)
{
    for (int metallic = 0; metallic < 2; metallic++) {
        struct stage stage;
        struct picture picture;
        if (!stage_create(run, &(struct stage_params){0}, &stage))
            return;
        struct scene_material *floor = &stage.scene->materials[stage.walls];
        floor->ior = 1.5f;
        floor->roughness = 0.0f;
        floor->metallic = (float)metallic;
        stage.camera.eye[1] = 0.001f;
        stage.camera.target[1] = 0.0005f;
        if (!stage_draw(run, &stage, &picture))
            return;
        stability_measure(run, (double)run->bad_values, "metallic %d", metallic);
        stability_keep(run, &picture, metallic ? "metal" : "lacquer");
        picture_finish(&picture);
    }
}

// Two-sided sheets in front of everything, one behind the other.
static void add_sheets(struct stage *stage, const struct scene_material *material, int count,
                       float uv_offset)
{
    for (int i = 0; i < count; i++) {
        static const float corners[6][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, -1}, {1, 1}, {-1, 1}};
        struct scene_vertex v[6];
        for (int j = 0; j < 6; j++) {
            v[j] = stage_vertex(0.5f * corners[j][0], 0.5f * corners[j][1], 0.0f);
            memcpy(v[j].normal, (float[3]){0.0f, 0.0f, 1.0f}, sizeof(v[j].normal));
            v[j].uv[0][0] = corners[j][0] + uv_offset;
            v[j].uv[0][1] = corners[j][1] + uv_offset;
        }
        struct scene_material sheet = *material;
        sheet.double_sided = true;
        stage_add_triangles(stage, v, 2, add_material(stage, &sheet),
                            (const float[3]){0.0f, 1.25f, 0.5f + 0.25f * (float)i});
    }
}

static bool draw_sheets(struct stability_run *run, const struct scene_material *material, int count,
                        struct picture *out_picture)
{
    struct stage stage;
    *out_picture = (struct picture){0};
    if (count == 0)
        return stage_draw_usual(run, out_picture);
    if (!stage_create(run, &(struct stage_params){0}, &stage))
        return false;
    add_sheets(&stage, material, count, 0.0f);
    return stage_draw(run, &stage, out_picture);
}

static void run_clear(struct stability_run *run)
{
    struct scene_material clear;
    struct picture expected, test;
    scene_material_init(&clear, "clear");
    clear.metallic = 0.0f;
    if (run->test->variant == 0) {
        clear.alpha_mode = SCENE_ALPHA_BLEND;
        clear.base_color[3] = 0.0f;
    } else {
        clear.transmission = 1.0f;
        clear.ior = 1.0f;
        clear.roughness = 0.0f;
    }
    if (draw_sheets(run, &clear, 0, &expected) && draw_sheets(run, &clear, 3, &test)) {
        stability_compare(run, &test, &expected, "");
        picture_finish(&test);
    }
    picture_finish(&expected);
}

static void run_opaque(struct stability_run *run)
{
    struct scene_material opaque;
    struct picture expected, test;
    scene_material_init(&opaque, "opaque");
    opaque.metallic = 0.0f;
    opaque.ior = 1.0f;
    opaque.base_color[2] = 0.25f;
    if (draw_sheets(run, &opaque, 1, &expected)) {
        opaque.alpha_mode = SCENE_ALPHA_BLEND;
        if (draw_sheets(run, &opaque, 1, &test)) {
            stability_compare(run, &test, &expected, "");
            picture_finish(&test);
        }
    }
    picture_finish(&expected);
}

static struct scene_material make_glowing(float strength)
{
    struct scene_material glowing;
    scene_material_init(&glowing, "glowing");
    glowing.metallic = 0.0f;
    for (int c = 0; c < 3; c++)
        glowing.emissive[c] = 1.0f;
    glowing.emissive_strength = strength;
    return glowing;
}

// Two black emitting walls: the image has exactly their radiance.
static void run_emission(struct stability_run *run)
{
    static const float strengths[2] = {1e6f, 1e-3f};
    struct stage stage = {.scene = scene_create("emission"), .scale = 1.0};
    if (!stage.scene)
        return;
    for (int i = 0; i < 2; i++) {
        struct scene_material glowing = make_glowing(strengths[i]);
        memset(glowing.base_color, 0, 3 * sizeof(float));
        glowing.ior = 1.0f;
        struct mesh_builder builder;
        mesh_builder_init(&builder);
        mesh_builder_add_quad(&builder, (const float[4][3]){{i == 0 ? -4.0f : 0.0f, -4.0f, 0.0f},
                                                            {i == 0 ? 0.0f : 4.0f, -4.0f, 0.0f},
                                                            {i == 0 ? 0.0f : 4.0f, 4.0f, 0.0f},
                                                            {i == 0 ? -4.0f : 0.0f, 4.0f, 0.0f}});
        stage_add(&stage, &builder, add_material(&stage, &glowing),
                  (const float[3]){0.0f, 0.0f, 0.0f});
    }
    struct frame_params params = stability_params(run);
    params.camera.eye[2] = 3.0f;
    struct picture picture;
    if (stability_draw(run, stage.scene, &params, &picture)) {
        for (uint32_t i = 0; i < picture.width * picture.height; i++) {
            uint32_t column = i % picture.width;
            if (column == picture.width / 2 || column + 1 == picture.width / 2)
                continue; // both are seen there
            double expected = strengths[column > picture.width / 2];
            for (size_t c = 0; c < 3; c++)
                stability_measure(run, fabs(picture.rgb[3 * (size_t)i + c] / expected - 1.0),
                                  "pixel %u, %u of %g cd/m^2", column, i / picture.width, expected);
        }
        picture_finish(&picture);
    }
    scene_destroy(&stage.scene);
}

// A dim room with something that glows a billion times brighter: no value leaves its range.
static void run_bright_and_dim(struct stability_run *run)
{
    struct stage stage;
    struct picture picture;
    if (!stage_create(run, &(struct stage_params){0}, &stage))
        return;
    static const float strengths[2] = {1e6f, 1e-3f};
    for (int i = 0; i < 2; i++) {
        struct scene_material glowing = make_glowing(strengths[i]);
        struct mesh_builder builder;
        mesh_builder_init(&builder);
        mesh_builder_add_sphere(&builder, (const float[3]){0.0f, 0.0f, 0.0f}, 0.25f, 16, 12);
        stage_add(&stage, &builder, add_material(&stage, &glowing),
                  (const float[3]){i == 0 ? -1.25f : 1.25f, 1.5f, -0.5f});
    }
    if (stage_draw(run, &stage, &picture)) {
        stability_measure(run, (double)run->bad_values, "image");
        stability_keep(run, &picture, "drawn");
        picture_finish(&picture);
    }
}

static bool draw_textured(struct stability_run *run, float uv_offset, struct picture *out_picture)
{
    struct stage stage;
    *out_picture = (struct picture){0};
    if (!stage_create(run, &(struct stage_params){0}, &stage))
        return false;
    uint8_t *texels = malloc(16);
    for (int i = 0; texels && i < 16; i++)
        texels[i] = i % 4 == 3 ? 255 : 188;
    struct image *image = texels ? image_create(2, 2, texels) : NULL;
    struct scene_material even;
    scene_material_init(&even, "even");
    even.metallic = 0.0f;
    even.ior = 1.0f;
    if (image) {
        even.textures[SCENE_TEXTURE_BASE_COLOR].image = scene_add_image(stage.scene, image);
        image_release(&image);
    } else {
        free(texels);
    }
    add_sheets(&stage, &even, 1, uv_offset);
    return stage_draw(run, &stage, out_picture);
}

static void run_far_uv(struct stability_run *run)
{
    struct picture expected, test;
    if (draw_textured(run, 0.0f, &expected) && draw_textured(run, 1e6f, &test)) {
        stability_compare(run, &test, &expected, "");
        picture_finish(&test);
    }
    picture_finish(&expected);
}

#define OF_BRIGHTEST "of the brightest"

static const struct stability_case cases[] = {
    {.name = "material-extremes",
     .invariant = "roughness, metal, IOR 0 to 3, black, alpha, glass, total reflection: finite",
     .methods = STABILITY_ALL,
     .bound = 0.0,
     .unit = "values not finite",
     .run = run_extremes},
    {.name = "material-grazing",
     .invariant = "a polished floor seen from 1 mm above it: finite",
     .methods = STABILITY_ALL,
     .bound = 0.0,
     .unit = "values not finite",
     .run = run_grazing},
    {.name = "material-alpha-0",
     .invariant = "three sheets of alpha 0, one behind the other, change no pixel",
     .methods = STABILITY_ALL,
     .bound = 0.004,
     .voxel_bound = 0.01,     // a sheet shares some of the ball's voxels
     .reference_bound = 0.01, // by chance, where rays start anew behind a sheet
     .unit = OF_BRIGHTEST,
     .run = run_clear,
     .variant = 0},
    {.name = "material-alpha-1",
     .invariant = "a blended sheet of alpha 1 looks as an opaque one",
     .methods = STABILITY_ALL,
     .bound = 0.004,
     .voxel_bound = 0.06, // pairs of opaque pixels share their look-ups
     .unit = OF_BRIGHTEST,
     .run = run_opaque},
    {.name = "material-transmission",
     .invariant = "three sheets of transmission 1 and IOR 1, one behind the other, change no pixel",
     .methods = STABILITY_ALL,
     .bound = 0.004,
     .voxel_bound = 0.01, // both for the same reasons
     .reference_bound = 0.01,
     .unit = OF_BRIGHTEST,
     .run = run_clear,
     .variant = 1},
    {.name = "material-emission",
     .invariant = "surfaces that emit 1e6 and 1e-3 cd/m^2, side by side, show just that",
     .methods = STABILITY_ALL,
     .bound = 0.001,
     .unit = "of the radiance",
     .run = run_emission},
    {.name = "material-bright-and-dim",
     .invariant = "balls that emit 1e6 and 1e-3 cd/m^2 in a room: finite",
     .methods = STABILITY_ALL,
     .bound = 0.0,
     .unit = "values not finite",
     .run = run_bright_and_dim},
    {.name = "material-far-uv",
     .invariant = "even textures look the same at texture coordinates of 1e6",
     .methods = STABILITY_ALL,
     .bound = 0.004,
     .unit = OF_BRIGHTEST,
     .run = run_far_uv},
};

const struct stability_table stability_material = {
    .name = "material",
    .title = "Material",
    .cases = cases,
    .count = sizeof(cases) / sizeof(cases[0]),
};
