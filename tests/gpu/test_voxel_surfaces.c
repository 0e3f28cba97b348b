// Proves what voxels record of surfaces: a texture's mean colour within the rounding of its
// smallest level, alpha and transmission as optical depth, an emissive texture as radiance, and the
// exact mean of thousands of coincident triangles, without overflow where there are more than sums
// can hold.
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "support_voxels.h"

#define EDGE       64u
#define HALF_SHEET 8
#define IMAGE_EDGE 64u
// Of an 8-bit sRGB value near the middle, twice over.
#define TEXEL_TOLERANCE 0.008

// What the volume holds of a voxel's face.
struct face_record {
    int32_t voxel[3];
    uint32_t face;
    double albedo[3];
    double direct[3];
    double depth;
};

static double half_to_double(uint32_t half)
{
    int exponent = (int)(half >> 10 & 31u);
    double mantissa = half & 1023u;
    double value = exponent == 0 ? ldexp(mantissa, -24) : ldexp(1024.0 + mantissa, exponent - 25);
    return half & 0x8000u ? -value : value;
}

static void unpack_face(const uint32_t *words, struct face_record *face)
{
    for (int c = 0; c < 3; c++)
        face->albedo[c] = (words[FACE_ALBEDO] >> (10 * c) & 1023u) / 1023.0;
    face->direct[0] = half_to_double(words[FACE_DIRECT] & 0xffffu);
    face->direct[1] = half_to_double(words[FACE_DIRECT] >> 16);
    face->direct[2] = half_to_double(words[FACE_DIRECT + 1] & 0xffffu);
    face->depth = half_to_double(words[FACE_DIRECT + 1] >> 16);
}

// All faces of a grid that look along an axis, but for the two specks; free() them.
static struct face_record *read_faces(const struct voxel_volume *volume, uint32_t face,
                                      size_t *out_count)
{
    size_t slots = (size_t)EDGE * EDGE * EDGE;
    size_t cell_bytes = gpu_buffer_size_bytes(volume->cells);
    size_t face_bytes = gpu_buffer_size_bytes(volume->faces);
    uint32_t *index = malloc(slots * 4), *cells = malloc(cell_bytes), *faces = malloc(face_bytes);
    struct face_record *records = calloc(slots, sizeof(*records));
    assert_true(index && cells && faces && records);
    gpu_buffer_read(volume->index, 0, slots * 4, index);
    gpu_buffer_read(volume->cells, 0, cell_bytes, cells);
    gpu_buffer_read(volume->faces, 0, face_bytes, faces);
    size_t count = 0;
    for (uint32_t slot = 0; slot < slots; slot++) {
        uint32_t number =
            index[slot] ? cells[(size_t)(index[slot] - 1) * CELL_WORDS + CELL_FACES + face] : 0;
        if (number == 0)
            continue;
        struct face_record *record = &records[count];
        record->face = face;
        bool speck = false;
        for (int axis = 0; axis < 3; axis++) {
            record->voxel[axis] = (int32_t)(slot >> (6 * axis) & 63u) - (int32_t)EDGE / 2;
            speck = speck || abs(record->voxel[axis]) > 25;
        }
        const uint32_t *words =
            &faces[(size_t)(number - 1) * FACE_RECORD_WORDS(volume->params.cache_cones)];
        if (speck || words[FACE_NORMAL] == VOXEL_NONE)
            continue;
        unpack_face(words, record);
        count++;
    }
    free(index);
    free(cells);
    free(faces);
    *out_count = count;
    return records;
}

// A sheet of quads that are 1 m wide, in a plane of z, facing +Z, half a voxel above the anchor;
// its texture repeats `repeats` times a metre.
static void add_sheet(struct scene *scene, uint32_t material, float repeats)
{
    const uint32_t quads = 2 * HALF_SHEET, row = quads + 1;
    struct scene_vertex *vertices = calloc((size_t)row * row, sizeof(*vertices));
    uint32_t *indices = calloc((size_t)quads * quads * 6, sizeof(*indices));
    assert_true(vertices && indices);
    for (uint32_t i = 0; i < row * row; i++) {
        struct scene_vertex *vertex = &vertices[i];
        uint32_t x = i % row, y = i / row;
        vertex->position[0] = (float)x - HALF_SHEET;
        vertex->position[1] = (float)y - HALF_SHEET;
        vertex->normal[2] = vertex->tangent[0] = vertex->tangent[3] = 1.0f;
        vertex->uv[0][0] = repeats * (float)x;
        vertex->uv[0][1] = repeats * (float)y;
        for (int c = 0; c < 4; c++)
            vertex->color[c] = 1.0f;
    }
    for (uint32_t i = 0; i < quads * quads; i++) {
        uint32_t a = i / quads * row + i % quads;
        const uint32_t quad[6] = {a, a + 1, a + row + 1, a, a + row + 1, a + row};
        memcpy(indices + (size_t)6 * i, quad, sizeof(quad));
    }
    uint32_t mesh = scene_add_mesh(scene, "sheet");
    assert_int_not_equal(
        scene_add_primitive(scene, vertices, row * row, indices, quads * quads * 6, material),
        SCENE_NONE);
    free(vertices);
    free(indices);
    uint32_t node = scene_add_node(scene, "sheet", SCENE_NONE);
    scene->nodes[node].mesh = mesh;
    for (int axis = 0; axis < 3; axis++)
        scene->nodes[node].translation[axis] = voxel_scene_anchor() + (axis == 2 ? 0.5f : 0.0f);
}

static double linear_of(uint8_t byte)
{
    double value = byte / 255.0;
    return value <= 0.04045 ? value / 12.92 : pow((value + 0.055) / 1.055, 2.4);
}

// An image of random squares, every other one transparent; and its mean, linear.
static uint32_t add_picture(struct scene *scene, double out_mean[4])
{
    uint8_t *rgba = malloc((size_t)IMAGE_EDGE * IMAGE_EDGE * 4);
    assert_non_null(rgba);
    uint64_t seed = 5;
    memset(out_mean, 0, 4 * sizeof(*out_mean));
    for (uint32_t i = 0; i < IMAGE_EDGE * IMAGE_EDGE; i++) {
        uint8_t *texel = rgba + (size_t)4 * i;
        for (int c = 0; c < 3; c++) {
            texel[c] = (uint8_t)(256.0 * pow(voxel_random(&seed), 1.0 + c));
            out_mean[c] += linear_of(texel[c]) / (IMAGE_EDGE * IMAGE_EDGE);
        }
        texel[3] = (i + i / IMAGE_EDGE) % 2 ? 255 : 0;
        out_mean[3] += texel[3] / 255.0 / (IMAGE_EDGE * IMAGE_EDGE);
    }
    struct image *image = image_create(IMAGE_EDGE, IMAGE_EDGE, rgba);
    assert_non_null(image);
    uint32_t number = scene_add_image(scene, image);
    image_release(&image);
    return number;
}

static void matte(struct scene_material *material)
{
    scene_material_init(material, "matte");
    material->metallic = 0.0f;
    material->ior = 1.0f;
}

// Voxelizes and lights the scene, and hands out the sheet's inner faces along +Z.
static struct face_record *sheet_faces(struct scene *scene, size_t *out_count)
{
    struct voxel_rig rig;
    voxel_rig_init(&rig, scene);
    struct voxel_volume *volume = voxel_rig_volume(&rig, GI_METHOD_GRID, EDGE, 0);
    voxel_rig_voxelize(&rig, volume, (const float[3]){0, 0, 0});
    voxel_rig_light(&rig, volume);
    size_t all, count = 0;
    struct face_record *records = read_faces(volume, VOXEL_FACE_POSITIVE_Z, &all);
    for (size_t i = 0; i < all; i++)
        if (abs(records[i].voxel[0]) < HALF_SHEET - 1 && abs(records[i].voxel[1]) < HALF_SHEET - 1)
            records[count++] = records[i];
    assert_int_equal(count, (2 * HALF_SHEET - 3) * (2 * HALF_SHEET - 3));
    voxel_volume_destroy(&volume);
    voxel_rig_finish(&rig);
    *out_count = count;
    return records;
}

static void assert_near(double found, double expected, double tolerance, const char *what)
{
    if (!(fabs(found - expected) <= tolerance))
        fail_msg("%s: %g, expected %g within %g", what, found, expected, tolerance);
}

static void test_texture_gives_its_mean_colour(void **state)
{
    (void)state;
    static const float repeats[] = {1.0f, 4.0f};
    for (size_t r = 0; r < 2; r++) {
        struct scene *scene = voxel_scene_create();
        double mean[4];
        struct scene_material material;
        matte(&material);
        material.base_color[1] = 0.5f;
        material.textures[SCENE_TEXTURE_BASE_COLOR].image = add_picture(scene, mean);
        add_sheet(scene, scene_add_material(scene, &material), repeats[r]);
        size_t count;
        struct face_record *faces = sheet_faces(scene, &count);
        for (size_t i = 0; i < count; i++)
            for (int c = 0; c < 3; c++)
                assert_near(faces[i].albedo[c], mean[c] * material.base_color[c], TEXEL_TOLERANCE,
                            "albedo");
        assert_near(faces[0].depth, VOXEL_MAX_DEPTH, 1e-3, "depth of what is opaque");
        free(faces);
        scene_destroy(&scene);
    }
}

// The texture spans the whole sheet once: no single voxel has its mean, but all together do.
static void test_large_texture_keeps_its_mean(void **state)
{
    (void)state;
    struct scene *scene = voxel_scene_create();
    double mean[4], sum[3] = {0.0};
    struct scene_material material;
    matte(&material);
    material.textures[SCENE_TEXTURE_BASE_COLOR].image = add_picture(scene, mean);
    add_sheet(scene, scene_add_material(scene, &material), 1.0f / (2 * HALF_SHEET - 3));
    size_t count;
    struct face_record *faces = sheet_faces(scene, &count);
    for (size_t i = 0; i < count; i++)
        for (int c = 0; c < 3; c++)
            sum[c] += faces[i].albedo[c] / (double)count;
    for (int c = 0; c < 3; c++)
        assert_near(sum[c], mean[c], 0.02, "mean of all voxels");
    free(faces);
    scene_destroy(&scene);
}

static void test_alpha_and_transmission_thin_voxels(void **state)
{
    (void)state;
    for (int kind = 0; kind < 4; kind++) {
        struct scene *scene = voxel_scene_create();
        double mean[4];
        struct scene_material material;
        matte(&material);
        double opacity = 0.0;
        if (kind == 0) { // a mask whose texture lets half through
            material.alpha_mode = SCENE_ALPHA_MASK;
            material.textures[SCENE_TEXTURE_BASE_COLOR].image = add_picture(scene, mean);
            opacity = mean[3];
        } else if (kind == 1) {
            material.alpha_mode = SCENE_ALPHA_BLEND;
            material.base_color[3] = 0.25f;
            opacity = 0.25;
        } else if (kind == 2) {
            material.transmission = 0.9f;
            opacity = 0.1;
        } else { // alpha means nothing where the material is opaque
            material.base_color[3] = 0.25f;
            opacity = 1.0;
        }
        add_sheet(scene, scene_add_material(scene, &material), 4.0f);
        double depth = fmin(-log(fmax(1.0 - opacity, 1e-9)), VOXEL_MAX_DEPTH);
        size_t count;
        struct face_record *faces = sheet_faces(scene, &count);
        for (size_t i = 0; i < count; i++)
            assert_near(faces[i].depth, depth, 0.01 * depth, "optical depth");
        free(faces);
        scene_destroy(&scene);
    }
}

static void test_emissive_texture_shines(void **state)
{
    (void)state;
    struct scene *scene = voxel_scene_create();
    double mean[4];
    struct scene_material material;
    matte(&material);
    material.emissive_strength = 40.0f;
    for (int c = 0; c < 3; c++)
        material.emissive[c] = 1.0f - 0.3f * (float)c;
    material.textures[SCENE_TEXTURE_EMISSIVE].image = add_picture(scene, mean);
    add_sheet(scene, scene_add_material(scene, &material), 2.0f);
    size_t count;
    struct face_record *faces = sheet_faces(scene, &count);
    for (size_t i = 0; i < count; i++)
        for (int c = 0; c < 3; c++)
            assert_near(faces[i].direct[c] / (40.0 * material.emissive[c]), mean[c],
                        TEXEL_TOLERANCE, "emitted radiance");
    free(faces);
    scene_destroy(&scene);
}

// `count` copies of the same triangle, which covers more than two voxels, in alternating colours.
static struct voxel_records coincident(uint32_t count, double out_mean[3])
{
    float *triangles = malloc(sizeof(float) * 9 * count),
          *colors = malloc(sizeof(float) * 3 * count);
    assert_true(triangles && colors);
    memset(out_mean, 0, 3 * sizeof(*out_mean));
    for (uint32_t i = 0; i < count; i++) {
        const float triangle[9] = {2.1f, 2.1f, 0.4f, 4.9f, 2.1f, 0.4f, 2.1f, 4.9f, 0.4f};
        memcpy(triangles + (size_t)9 * i, triangle, sizeof(triangle));
        const float color[3] = {(float)(i % 256u) / 255.0f, (float)(i / 3 % 256u) / 255.0f,
                                i % 5 ? 0.2f : 1.0f};
        memcpy(colors + (size_t)3 * i, color, sizeof(color));
        for (int c = 0; c < 3; c++)
            out_mean[c] += (double)color[c] / count;
    }
    struct scene *scene = voxel_scene_create();
    voxel_scene_add(scene, triangles, count, colors, 0);
    free(triangles);
    free(colors);
    struct voxel_rig rig;
    voxel_rig_init(&rig, scene);
    struct voxel_volume *volume = voxel_rig_volume(&rig, GI_METHOD_GRID, EDGE, 0);
    voxel_rig_voxelize(&rig, volume, (const float[3]){0, 0, 0});
    struct voxel_records records = voxel_read_records(volume);
    voxel_volume_destroy(&volume);
    voxel_rig_finish(&rig);
    scene_destroy(&scene);
    return records;
}

// Largest distance of any surfel's mean colour and normal from what they are.
static double largest_error(const struct voxel_records *records, const double mean[3],
                            uint32_t *out_surfels)
{
    double largest = 0.0;
    *out_surfels = 0;
    for (size_t i = 0; i < records->count; i++) {
        const struct voxel_record *record = &records->records[i];
        if (voxel_record_word(record, SURFEL_KEY) >> 3 != 1)
            continue;
        double weight = voxel_record_word(record, SURFEL_WEIGHT);
        for (uint32_t c = 0; c < 3; c++) {
            double color = voxel_record_word(record, SURFEL_COLOR + c) / weight / 255.0;
            largest = fmax(largest, fabs(color - mean[c]));
            double normal = (int32_t)voxel_record_word(record, SURFEL_NORMAL + c) / weight / 127.0;
            largest = fmax(largest, fabs(normal - (c == 2 ? 1.0 : 0.0)));
        }
        (*out_surfels)++;
    }
    return largest;
}

static void test_coincident_triangles_have_their_mean(void **state)
{
    (void)state;
    double mean[3];
    uint32_t surfels;
    struct voxel_records records = coincident(7680, mean);
    double error = largest_error(&records, mean, &surfels);
    print_message("  7680 triangles, %u surfels: largest error %g\n", surfels, error);
    assert_true(surfels >= 5);
    assert_true(error < 1e-6);
    free(records.records);
}

static void test_sums_do_not_overflow(void **state)
{
    (void)state;
    double mean[3];
    uint32_t surfels;
    struct voxel_records records = coincident(500000, mean);
    double error = largest_error(&records, mean, &surfels);
    print_message("  500000 triangles, %u surfels: largest error %g\n", surfels, error);
    assert_true(surfels >= 5);
    assert_true(error < 0.01);
    free(records.records);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_texture_gives_its_mean_colour),
        cmocka_unit_test(test_large_texture_keeps_its_mean),
        cmocka_unit_test(test_alpha_and_transmission_thin_voxels),
        cmocka_unit_test(test_emissive_texture_shines),
        cmocka_unit_test(test_coincident_triangles_have_their_mean),
        cmocka_unit_test(test_sums_do_not_overflow),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
