// Proves that scene_load() picks the importer by content and extension, names what it supports, and
// records the files that a scene was read from. Uses small files in a temporary folder.
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include <glob.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "renderer/import/importers.h"
#include "renderer/import/scene_load.h"
#include "voxcast_paths.h"

static char folder[] = "/tmp/voxcast-load-XXXXXX";

static const char *write_file(const char *name, const char *text)
{
    static char path[256];
    snprintf(path, sizeof(path), "%s/%s", folder, name);
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(text, 1, strlen(text), file), strlen(text));
    fclose(file);
    return path;
}

static void check_loads(const char *path)
{
    struct error error = {{0}};
    struct scene *scene = scene_load(path, &error);
    if (!scene) {
        fail_msg("%s", error.message);
    }
    char *canonical = realpath(path, NULL);
    assert_string_equal(scene->source_path, canonical);
    assert_int_equal(scene->source_file_count, 1);
    assert_string_equal(scene->source_files[0], canonical);
    free(canonical);
    scene_destroy(&scene);
    unlink(path);
}

static void test_kinds(void **state)
{
    (void)state;
    check_loads(write_file("a.gltf", "{\"asset\":{\"version\":\"2.0\"}}"));
    check_loads(write_file("A.OBJ", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"));
}

static void test_unknown_kind_and_missing_file(void **state)
{
    (void)state;
    struct error error;
    const char *path = write_file("a.fbx", "Kaydara");
    assert_null(scene_load(path, &error));
    assert_non_null(strstr(error.message, ".gltf"));
    assert_non_null(strstr(error.message, ".obj"));
    unlink(path);
    assert_null(scene_load(path, &error));
    assert_non_null(strstr(error.message, "a.fbx"));
    assert_null(scene_load(folder, &error));
    assert_non_null(strstr(error.message, "regular file"));
}

// Those of the stability suite and of the fuzzers: corpus/NAME is that of fuzz_NAME.
static void test_every_importer_has_hostile_files(void **state)
{
    (void)state;
    for (uint32_t i = 0; importer_at(i); i++) {
        const struct importer *importer = importer_at(i);
        char path[1024], name[64];
        glob_t found;
        assert_string_equal(importer->extension, scene_file_extension(i));
        assert_true(importer->file && importer->memory);
        snprintf(path, sizeof(path), "%s/tests/fuzz/corpus/*/*%s", VOXCAST_SOURCE_DIR,
                 importer->extension);
        if (glob(path, 0, NULL, &found) != 0)
            fail_msg("there is no %s", path);
        assert_int_equal(
            sscanf(found.gl_pathv[0] + strlen(VOXCAST_SOURCE_DIR "/tests/fuzz/corpus/"), "%63[^/]",
                   name),
            1);
        globfree(&found);
        snprintf(path, sizeof(path), "%s/tests/fuzz/fuzz_%s.c", VOXCAST_SOURCE_DIR, name);
        if (access(path, R_OK) != 0)
            fail_msg("there is no %s", path);
    }
}

static void test_importers_are_found_by_extension(void **state)
{
    (void)state;
    assert_string_equal(importer_of("a/b.GLB")->extension, ".glb");
    assert_string_equal(importer_of("a.gltf.obj")->extension, ".obj");
    assert_null(importer_of("a.gltf/b"));
    assert_null(importer_of("gltf"));
    assert_null(importer_of(".obj"));
}

// Triangles at no place are left out; a primitive of nothing else is refused.
static void test_primitives_have_triangles(void **state)
{
    (void)state;
    struct scene *scene = scene_create("scene");
    struct scene_material white;
    scene_material_init(&white, "white");
    assert_int_equal(scene_add_material(scene, &white), 0);
    assert_int_equal(scene_add_mesh(scene, "mesh"), 0);
    struct scene_vertex vertices[4] = {{.position = {0, 0, 0}},
                                       {.position = {1, 0, 0}},
                                       {.position = {0, 1, 0}},
                                       {.position = {NAN, 0, 0}}};
    static const uint32_t indices[6] = {0, 1, 3, 0, 1, 2};
    uint64_t before = scene->revisions.geometry;
    assert_int_equal(scene_add_primitive(scene, vertices, 4, indices, 3, 0), SCENE_NONE);
    assert_int_equal(scene_add_primitive(scene, vertices, 4, indices, 0, 0), SCENE_NONE);
    assert_int_equal(scene->primitive_count + scene->vertex_count + scene->index_count, 0);
    assert_int_equal(scene->meshes[0].primitive_count, 0);
    assert_int_equal(scene->rejects.triangles, 1);
    assert_int_equal(scene->revisions.geometry, before);
    assert_int_equal(scene_add_primitive(scene, vertices, 4, indices, 6, 0), 0);
    assert_int_equal(scene->primitives[0].index_count, 3);
    assert_int_equal(scene->rejects.triangles, 2);
    scene_destroy(&scene);
}

static void test_builtin(void **state)
{
    (void)state;
    char source[128];
    struct error error = {{0}};
    snprintf(source, sizeof(source), "builtin:%s", scene_builtin_name(0));
    struct scene *scene = scene_load(source, &error);
    assert_non_null(scene);
    assert_string_equal(scene->source_path, source);
    assert_int_equal(scene->source_file_count, 0);
    scene_destroy(&scene);
    assert_null(scene_load("builtin:no-such-scene", &error));
    assert_true(strlen(error.message) > 0);
}

static int make_folder(void **state)
{
    (void)state;
    return mkdtemp(folder) ? 0 : -1;
}

static int remove_folder(void **state)
{
    (void)state;
    return rmdir(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_kinds),
        cmocka_unit_test(test_unknown_kind_and_missing_file),
        cmocka_unit_test(test_every_importer_has_hostile_files),
        cmocka_unit_test(test_importers_are_found_by_extension),
        cmocka_unit_test(test_primitives_have_triangles),
        cmocka_unit_test(test_builtin),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
