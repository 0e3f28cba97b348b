// Proves that OBJ and MTL files become the right scene: faces of any shape, indices, smoothing,
// materials with and without metallic-roughness keys, masks, bump maps, names with spaces, and
// confinement to the folder. Small files are written to a temporary folder and compared value by
// value. Also reads Crytek's Sponza where the folder of test scenes has it.
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "renderer/import/importers.h"
#include "renderer/import/scene_load.h"
#include "support_scenes.h"

#define TOLERANCE 1e-5f

static struct scene *import_text(const char *text, struct error *out_error)
{
    return scene_import_obj_memory(text, strlen(text), NULL, out_error);
}

static struct scene *import_sound(const char *text)
{
    struct error error = {{0}};
    struct scene *scene = import_text(text, &error);
    if (!scene) {
        fail_msg("%s", error.message);
    }
    support_check_scene(scene);
    return scene;
}

static double area_of(const struct scene *scene)
{
    double area = 0;
    for (uint32_t i = 0; i < scene->index_count; i += 3) {
        const float *a = scene->vertices[scene->indices[i]].position;
        const float *b = scene->vertices[scene->indices[i + 1]].position;
        const float *c = scene->vertices[scene->indices[i + 2]].position;
        area += ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])) / 2;
    }
    return area;
}

static void test_concave_face(void **state)
{
    (void)state;
    // An L of area 3 and a pentagon with a notch, both in the plane z = 0, wound to the left:
    // signed areas add up only if no triangle overlaps another or lies outside.
    struct scene *scene = import_sound("v 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\n"
                                       "f 1 2 3 4 5 6\n");
    assert_int_equal(scene->index_count, 12);
    assert_float_equal(area_of(scene), 3, TOLERANCE);
    for (uint32_t i = 0; i < scene->vertex_count; i++) {
        assert_float_equal(scene->vertices[i].normal[2], 1, TOLERANCE);
    }
    scene_destroy(&scene);
    scene = import_sound("v 0 0 0\nv 4 0 0\nv 4 4 0\nv 2 1 0\nv 0 4 0\nf 1 2 3 4 5\n");
    assert_int_equal(scene->index_count, 9);
    assert_float_equal(area_of(scene), 10, TOLERANCE);
    scene_destroy(&scene);
}

static void test_indices_and_lines(void **state)
{
    (void)state;
    // Negative indices, a continued line, line ends of Windows, and V pointing up.
    struct scene *scene = import_sound("v 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\nvt 0 0\r\nvt 1 0.25\r\n"
                                       "vn 0 0 2\r\nf -3/-2/-1 \\\r\n 2/2/1 3//1\r\n");
    assert_int_equal(scene->index_count, 3);
    const struct scene_vertex *second = &scene->vertices[scene->indices[1]];
    assert_float_equal(second->position[0], 1, 0);
    assert_float_equal(second->uv[0][0], 1, 0);
    assert_float_equal(second->uv[0][1], 0.75f, TOLERANCE);
    assert_float_equal(second->normal[2], 1, TOLERANCE);
    scene_destroy(&scene);
    static const char *const REFUSED[] = {"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n",
                                          "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n",
                                          "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -4 1 2\n",
                                          "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4294967299\n", ""};
    for (size_t i = 0; i < sizeof(REFUSED) / sizeof(REFUSED[0]); i++) {
        struct error error = {{0}};
        assert_null(import_text(REFUSED[i], &error));
        assert_true(strlen(error.message) > 10);
    }
}

static void test_smoothing_groups(void **state)
{
    (void)state;
    // A roof: two quads that meet along the ridge x = 1.
    static const char ROOF[] = "v 0 0 0\nv 1 1 0\nv 1 1 -1\nv 0 0 -1\nv 2 0 0\nv 2 0 -1\n"
                               "s %s\nf 1 2 3 4\nf 2 5 6 3\n";
    char text[512];
    snprintf(text, sizeof(text), ROOF, "1");
    struct scene *scene = import_sound(text);
    assert_int_equal(scene->vertex_count, 6);
    for (uint32_t i = 0; i < scene->vertex_count; i++) {
        if (scene->vertices[i].position[0] == 1) {
            assert_float_equal(scene->vertices[i].normal[0], 0, TOLERANCE);
            assert_float_equal(scene->vertices[i].normal[1], 1, TOLERANCE);
        }
    }
    scene_destroy(&scene);
    snprintf(text, sizeof(text), ROOF, "off");
    scene = import_sound(text);
    assert_int_equal(scene->vertex_count, 8); // the ridge is split
    for (uint32_t i = 0; i < scene->vertex_count; i++) {
        assert_float_equal(fabsf(scene->vertices[i].normal[0]), sqrtf(0.5f), TOLERANCE);
    }
    scene_destroy(&scene);
}

// A temporary folder with files that a test writes; all of it is removed at the end.
struct fixture {
    char folder[64];
    char names[8][256];
    uint32_t count;
};

static void write_file(struct fixture *fixture, const char *name, const void *bytes, size_t size)
{
    char path[256];
    snprintf(path, sizeof(path), "%s/%s", fixture->folder, name);
    memcpy(fixture->names[fixture->count++], path, sizeof(path));
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    fclose(file);
}

// An uncompressed TGA of 2 x 2 grey pixels, rows from the top.
static void write_grey(struct fixture *fixture, const char *name, const uint8_t values[4])
{
    uint8_t bytes[18 + 12] = {[2] = 2, [12] = 2, [14] = 2, [16] = 24, [17] = 0x20};
    for (int i = 0; i < 12; i++) {
        bytes[18 + i] = values[i / 3];
    }
    write_file(fixture, name, bytes, sizeof(bytes));
}

static int set_up_folder(void **state)
{
    struct fixture *fixture = calloc(1, sizeof(*fixture));
    assert_non_null(fixture);
    strcpy(fixture->folder, "/tmp/voxcast-obj-XXXXXX");
    assert_non_null(mkdtemp(fixture->folder));
    *state = fixture;
    return 0;
}

static int tear_down_folder(void **state)
{
    struct fixture *fixture = *state;
    for (uint32_t i = 0; i < fixture->count; i++) {
        unlink(fixture->names[i]);
    }
    rmdir(fixture->folder);
    free(fixture);
    return 0;
}

#define MATERIAL_OBJ                                                                               \
    "mtllib my materials.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n"                 \
    "usemtl plain\nf 1/1 2/2 3/3\nusemtl rich one\nf 1/1 2/2 3/3\nusemtl glass\nf 1 2 3\n"

#define MATERIAL_MTL                                                                               \
    "newmtl plain\nKd 0.1 0.2 0.3\nNs 98\nNi 1.4\n"                                                \
    "newmtl rich one\nKd 1 1 1\nPr 0.3\nPm 0.9\nKe 4 2 0\nmap_Pm metal.tga\n"                      \
    "map_d -imfchan m my mask.tga\nmap_Bump -bm 2 heights.tga\n"                                   \
    "newmtl glass\nKd 1 1 1\nTr 0.75\nmap_Kd ../secret.png\n"

static const struct scene_material *find_material(const struct scene *scene, const char *name)
{
    for (uint32_t i = 0; i < scene->material_count; i++) {
        if (strcmp(scene->materials[i].name, name) == 0) {
            return &scene->materials[i];
        }
    }
    fail_msg("no material %s", name);
    return NULL;
}

static const uint8_t *texel_of(const struct scene *scene, const struct scene_material *material,
                               enum scene_texture_slot slot, uint32_t texel)
{
    assert_true(material->textures[slot].image != SCENE_NONE);
    return scene->images[material->textures[slot].image]->rgba + (size_t)texel * 4;
}

static void test_materials(void **state)
{
    struct fixture *fixture = *state;
    write_file(fixture, "scene.obj", MATERIAL_OBJ, strlen(MATERIAL_OBJ));
    write_file(fixture, "my materials.mtl", MATERIAL_MTL, strlen(MATERIAL_MTL));
    write_grey(fixture, "metal.tga", (uint8_t[]){10, 20, 30, 40});
    write_grey(fixture, "my mask.tga", (uint8_t[]){255, 0, 255, 0});
    write_grey(fixture, "heights.tga", (uint8_t[]){0, 0, 0, 0});
    struct error error = {{0}};
    struct scene *scene = scene_import_obj(fixture->names[0], &error);
    if (!scene) {
        fail_msg("%s", error.message);
    }
    support_check_scene(scene);
    assert_int_equal(scene->primitive_count, 3);
    assert_int_equal(scene->source_file_count, 5);

    const struct scene_material *plain = find_material(scene, "plain");
    assert_float_equal(plain->roughness, sqrtf(2.0f / 100.0f), TOLERANCE);
    assert_float_equal(plain->metallic, 0, 0);
    assert_float_equal(plain->base_color[1], 0.2f, TOLERANCE);
    assert_float_equal(plain->ior, 1.4f, TOLERANCE);

    const struct scene_material *rich = find_material(scene, "rich one");
    assert_float_equal(rich->roughness, 0.3f, TOLERANCE);
    assert_float_equal(rich->metallic, 1, 0); // the image holds it
    assert_int_equal(texel_of(scene, rich, SCENE_TEXTURE_METALLIC_ROUGHNESS, 2)[2], 30);
    assert_int_equal(texel_of(scene, rich, SCENE_TEXTURE_METALLIC_ROUGHNESS, 2)[1], 255);
    assert_int_equal(rich->alpha_mode, SCENE_ALPHA_MASK);
    assert_int_equal(texel_of(scene, rich, SCENE_TEXTURE_BASE_COLOR, 0)[3], 255);
    assert_int_equal(texel_of(scene, rich, SCENE_TEXTURE_BASE_COLOR, 1)[3], 0);
    assert_int_equal(texel_of(scene, rich, SCENE_TEXTURE_NORMAL, 0)[2], 255); // flat heights
    assert_float_equal(rich->emissive_strength, 4, TOLERANCE);
    assert_float_equal(rich->emissive[1], 0.5f, TOLERANCE);

    const struct scene_material *glass = find_material(scene, "glass");
    assert_int_equal(glass->alpha_mode, SCENE_ALPHA_BLEND);
    assert_float_equal(glass->base_color[3], 0.25f, TOLERANCE);
    assert_int_equal(glass->textures[SCENE_TEXTURE_BASE_COLOR].image, SCENE_NONE);
    assert_true(scene->warning_count > 0);
    scene_destroy(&scene);
}

static void test_libraries_stay_in_the_folder(void **state)
{
    (void)state;
    struct scene *scene = import_sound("mtllib /etc/passwd\nmtllib ../x.mtl\nusemtl gone\n"
                                       "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    assert_int_equal(scene->source_file_count, 0);
    assert_int_equal(scene->warning_count, 3);
    scene_destroy(&scene);
}

// The archive is unpacked for the test and removed again.
static void test_sponza(void **state)
{
    (void)state;
    const char *archive = support_scene_path("sponza-obj.tar.xz");
    if (!archive) {
        skip();
    }
    char folder[] = "/tmp/voxcast-sponza-XXXXXX", command[2200], path[200];
    assert_non_null(mkdtemp(folder));
    snprintf(command, sizeof(command), "tar -xJf '%s' -C '%s'", archive, folder);
    assert_int_equal(system(command), 0);
    snprintf(command, sizeof(command), "find '%s' -name '*.obj' -print -quit", folder);
    FILE *found = popen(command, "r");
    assert_non_null(found);
    assert_non_null(fgets(path, sizeof(path), found));
    pclose(found);
    path[strcspn(path, "\n")] = '\0';
    struct error error;
    struct scene *scene = scene_import_obj(path, &error);
    snprintf(command, sizeof(command), "rm -r '%s'", folder);
    assert_int_equal(system(command), 0);
    assert_non_null(scene);
    support_check_scene(scene);
    assert_int_equal(scene_triangle_count(scene), 262087);
    scene_destroy(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_concave_face),
        cmocka_unit_test(test_indices_and_lines),
        cmocka_unit_test(test_smoothing_groups),
        cmocka_unit_test_setup_teardown(test_materials, set_up_folder, tear_down_folder),
        cmocka_unit_test(test_libraries_stay_in_the_folder),
        cmocka_unit_test(test_sponza),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
