// Proves that glTF files become the right scene: placement, materials, lights, cameras, animations,
// accessor kinds, primitive modes, generated normals and tangents. Small files are written here as
// text with data URIs and compared value by value. In the folder of test scenes, where present,
// everything must be finite and in range.
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include <dirent.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "renderer/import/importers.h"
#include "renderer/import/scene_load.h"
#include "support_scenes.h"

#define TOLERANCE 1e-5f

static void write_base64(const void *bytes, size_t size, char *out)
{
    static const char DIGITS[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const uint8_t *from = bytes;
    for (size_t i = 0; i < size; i += 3) {
        uint32_t bits = (uint32_t)from[i] << 16 | (i + 1 < size ? (uint32_t)from[i + 1] << 8 : 0) |
                        (i + 2 < size ? from[i + 2] : 0);
        for (int digit = 0; digit < 4; digit++) {
            *out++ = DIGITS[bits >> (18 - 6 * digit) & 63];
        }
    }
    *out = '\0';
}

// A glTF text around one buffer of `size` bytes; `rest` is everything but asset and buffers.
static struct scene *import_text(const void *buffer, size_t size, const char *rest,
                                 struct error *out_error)
{
    static char base64[4096], text[16384];
    write_base64(buffer, size, base64);
    snprintf(text, sizeof(text),
             "{\"asset\":{\"version\":\"2.0\"},\"buffers\":[{\"byteLength\":%zu,\"uri\":"
             "\"data:application/octet-stream;base64,%s\"}],%s}",
             size, base64, rest);
    return scene_import_gltf_memory(text, strlen(text), NULL, out_error);
}

static struct scene *import_sound(const void *buffer, size_t size, const char *rest)
{
    struct error error = {{0}};
    struct scene *scene = import_text(buffer, size, rest, &error);
    if (!scene) {
        fail_msg("%s", error.message);
    }
    support_check_scene(scene);
    return scene;
}

static const float QUAD[4][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};

#define QUAD_VIEW                                                                                  \
    "\"bufferViews\":[{\"buffer\":0,\"byteLength\":48}],"                                          \
    "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"}]"

static void test_primitive_modes(void **state)
{
    (void)state;
    static const struct {
        int mode;
        uint32_t index_count;
    } MODES[] = {{0, 0}, {1, 0}, {2, 0}, {3, 0}, {4, 3}, {5, 6}, {6, 6}};
    for (size_t i = 0; i < sizeof(MODES) / sizeof(MODES[0]); i++) {
        char rest[1024];
        snprintf(rest, sizeof(rest),
                 "%s,\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"mode\":%d}]}],"
                 "\"nodes\":[{\"mesh\":0}]",
                 QUAD_VIEW, MODES[i].mode);
        struct scene *scene = import_sound(QUAD, sizeof(QUAD), rest);
        assert_int_equal(scene->index_count, MODES[i].index_count);
        assert_int_equal(scene->warning_count > 0, MODES[i].mode != 5 && MODES[i].mode != 6);
        for (uint32_t vertex = 0; vertex < scene->vertex_count && MODES[i].mode == 6; vertex++) {
            assert_float_equal(scene->vertices[vertex].normal[2], 1, TOLERANCE);
        }
        scene_destroy(&scene);
    }
}

static void test_strip_winding(void **state)
{
    (void)state;
    // Strip order of a quad: both triangles must face +Z.
    static const float STRIP[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
    struct scene *scene =
        import_sound(STRIP, sizeof(STRIP),
                     QUAD_VIEW ",\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0},"
                               "\"mode\":5}]}],\"nodes\":[{\"mesh\":0}]");
    assert_int_equal(scene->index_count, 6);
    for (uint32_t i = 0; i < scene->vertex_count; i++) {
        assert_float_equal(scene->vertices[i].normal[2], 1, TOLERANCE);
    }
    scene_destroy(&scene);
}

// Normalized and quantized attributes, interleaved, with 8-bit indices and a sparse position.
static void test_accessor_kinds(void **state)
{
    (void)state;
    struct packed_vertex {
        int16_t position[4];
        int8_t normal[4];
        uint16_t uv[2];
        uint8_t color[4];
    };
    struct {
        struct packed_vertex vertices[3];
        uint8_t indices[4];
        uint16_t sparse_index[2];
        int16_t sparse_value[4];
    } data = {
        .vertices = {{{0, 0, 0}, {0, 0, 127}, {0, 0}, {255, 0, 0, 255}},
                     {{2, 0, 0}, {0, 0, 127}, {65535, 0}, {0, 255, 0, 255}},
                     {{0, 2, 0}, {0, 0, -128}, {0, 65535}, {0, 0, 51, 0}}},
        .indices = {2, 0, 1},
        .sparse_index = {1},
        .sparse_value = {5, 0, 0},
    };
    struct scene *scene = import_sound(
        &data, sizeof(data),
        "\"extensionsUsed\":[\"KHR_mesh_quantization\"],"
        "\"bufferViews\":[{\"buffer\":0,\"byteLength\":60,\"byteStride\":20},"
        "{\"buffer\":0,\"byteOffset\":60,\"byteLength\":3},"
        "{\"buffer\":0,\"byteOffset\":64,\"byteLength\":2},"
        "{\"buffer\":0,\"byteOffset\":68,\"byteLength\":8}],"
        "\"accessors\":[{\"bufferView\":0,\"componentType\":5122,\"count\":3,\"type\":\"VEC3\","
        "\"sparse\":{\"count\":1,\"indices\":{\"bufferView\":2,\"componentType\":5123},"
        "\"values\":{\"bufferView\":3}}},"
        "{\"bufferView\":0,\"byteOffset\":8,\"componentType\":5120,\"normalized\":true,"
        "\"count\":3,\"type\":\"VEC3\"},"
        "{\"bufferView\":0,\"byteOffset\":12,\"componentType\":5123,\"normalized\":true,"
        "\"count\":3,\"type\":\"VEC2\"},"
        "{\"bufferView\":0,\"byteOffset\":16,\"componentType\":5121,\"normalized\":true,"
        "\"count\":3,\"type\":\"VEC4\"},"
        "{\"bufferView\":1,\"componentType\":5121,\"count\":3,\"type\":\"SCALAR\"}],"
        "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"NORMAL\":1,"
        "\"TEXCOORD_0\":2,\"COLOR_0\":3},\"indices\":4}]}],\"nodes\":[{\"mesh\":0}]");
    assert_int_equal(scene->index_count, 3);
    const struct scene_vertex *third = &scene->vertices[scene->indices[0]];
    const struct scene_vertex *moved = &scene->vertices[scene->indices[2]];
    assert_float_equal(third->position[1], 2, 0);
    assert_float_equal(third->normal[2], -1, TOLERANCE);
    assert_float_equal(third->uv[0][1], 1, TOLERANCE);
    assert_float_equal(third->color[2], 0.2f, TOLERANCE);
    assert_float_equal(third->color[3], 0, 0);
    assert_float_equal(moved->position[0], 5, 0);
    scene_destroy(&scene);
}

static void test_nodes_lights_cameras(void **state)
{
    (void)state;
    // The child comes first in the file; the matrix turns X to Y, scales by 2 and mirrors Z.
    struct scene *scene = import_sound(
        QUAD, sizeof(QUAD),
        QUAD_VIEW
        ",\"extensions\":{\"KHR_lights_punctual\":{\"lights\":[{\"type\":\"spot\",\"intensity\":7,"
        "\"range\":3,\"color\":[1,0.5,0],\"spot\":{\"innerConeAngle\":0.1,\"outerConeAngle\":0.2}}"
        "]}},\"cameras\":[{\"type\":\"perspective\",\"perspective\":{\"yfov\":0.7,\"znear\":0.1}}],"
        "\"nodes\":[{\"name\":\"child\",\"camera\":0,\"extensions\":{\"KHR_lights_punctual\":"
        "{\"light\":0}}},{\"name\":\"parent\",\"children\":[0],"
        "\"matrix\":[0,2,0,0,-2,0,0,0,0,0,-2,0,1,2,3,1]}],"
        "\"scene\":0,\"scenes\":[{\"nodes\":[1]}]");
    assert_int_equal(scene->node_count, 2);
    assert_string_equal(scene->nodes[0].name, "parent");
    assert_int_equal(scene->nodes[1].parent, 0);
    static const float EXPECTED[16] = {0, 2, 0, 0, -2, 0, 0, 0, 0, 0, -2, 0, 1, 2, 3, 1};
    for (int i = 0; i < 16; i++) {
        assert_float_equal(scene->nodes[0].world_from_local[i], EXPECTED[i], TOLERANCE);
    }
    assert_int_equal(scene->light_count, 1);
    assert_int_equal(scene->lights[0].type, SCENE_LIGHT_SPOT);
    assert_int_equal(scene->lights[0].node, 1);
    assert_float_equal(scene->lights[0].intensity, 7, 0);
    assert_float_equal(scene->lights[0].range_m, 3, 0);
    assert_float_equal(scene->lights[0].color[1], 0.5f, 0);
    assert_float_equal(scene->lights[0].inner_cone_rad, 0.1f, 0);
    assert_float_equal(scene->lights[0].outer_cone_rad, 0.2f, 0);
    assert_int_equal(scene->camera_count, 1);
    assert_float_equal(scene->cameras[0].fov_y_rad, 0.7f, 0);
    scene_destroy(&scene);
}

static void test_materials(void **state)
{
    (void)state;
    struct scene *scene = import_sound(
        QUAD, sizeof(QUAD),
        QUAD_VIEW
        ",\"materials\":[{\"name\":\"all\",\"alphaMode\":\"MASK\",\"alphaCutoff\":0.3,"
        "\"doubleSided\":true,\"emissiveFactor\":[1,0,0.5],\"pbrMetallicRoughness\":"
        "{\"baseColorFactor\":[0.1,0.2,0.3,0.4],\"metallicFactor\":0.6,\"roughnessFactor\":0.7},"
        "\"extensions\":{\"KHR_materials_emissive_strength\":{\"emissiveStrength\":9},"
        "\"KHR_materials_ior\":{\"ior\":0},\"KHR_materials_transmission\":"
        "{\"transmissionFactor\":0.8},\"KHR_materials_volume\":{\"thicknessFactor\":2,"
        "\"attenuationDistance\":5,\"attenuationColor\":[0.1,0.2,0.3]},"
        "\"KHR_materials_specular\":{\"specularFactor\":0.25,"
        "\"specularColorFactor\":[1,0.5,2]}}},"
        "{\"extensions\":{\"KHR_materials_unlit\":{}},\"pbrMetallicRoughness\":"
        "{\"roughnessFactor\":-3}}]");
    const struct scene_material *material = &scene->materials[0];
    assert_string_equal(material->name, "all");
    assert_int_equal(material->alpha_mode, SCENE_ALPHA_MASK);
    assert_float_equal(material->alpha_cutoff, 0.3f, TOLERANCE);
    assert_true(material->double_sided);
    assert_float_equal(material->base_color[3], 0.4f, TOLERANCE);
    assert_float_equal(material->metallic, 0.6f, TOLERANCE);
    assert_float_equal(material->roughness, 0.7f, TOLERANCE);
    assert_float_equal(material->emissive[2], 0.5f, TOLERANCE);
    assert_float_equal(material->emissive_strength, 9, TOLERANCE);
    assert_float_equal(material->ior, 0, 0);
    assert_float_equal(material->transmission, 0.8f, TOLERANCE);
    assert_float_equal(material->thickness_m, 2, TOLERANCE);
    assert_float_equal(material->attenuation_distance_m, 5, TOLERANCE);
    assert_float_equal(material->attenuation_color[2], 0.3f, TOLERANCE);
    assert_float_equal(material->specular, 0.25f, TOLERANCE);
    assert_float_equal(material->specular_color[2], 2, TOLERANCE);
    assert_int_equal(scene->materials[1].shading, SCENE_SHADING_UNLIT);
    assert_float_equal(scene->materials[1].roughness, 0, 0); // clamped, with a warning
    assert_float_equal(scene->materials[1].ior, 1.5f, 0);
    assert_true(scene->warning_count > 0);
    scene_destroy(&scene);
}

static void test_animation(void **state)
{
    (void)state;
    static const float DATA[8] = {0, 2, /* values */ 0, 0, 0, 4, 0, 0};
    struct scene *scene =
        import_sound(DATA, sizeof(DATA),
                     "\"bufferViews\":[{\"buffer\":0,\"byteLength\":8},"
                     "{\"buffer\":0,\"byteOffset\":8,\"byteLength\":24}],"
                     "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":2,"
                     "\"type\":\"SCALAR\"},{\"bufferView\":1,\"componentType\":5126,\"count\":2,"
                     "\"type\":\"VEC3\"}],\"nodes\":[{}],\"animations\":[{\"name\":\"move\","
                     "\"channels\":[{\"sampler\":0,\"target\":{\"node\":0,\"path\":"
                     "\"translation\"}}],\"samplers\":[{\"input\":0,\"output\":1}]}]");
    assert_int_equal(scene->animation_count, 1);
    assert_float_equal(scene->animations[0].duration_s, 2, 0);
    scene_animate(scene, 0, 0.5f);
    assert_float_equal(scene->nodes[0].world_from_local[12], 1, TOLERANCE);
    scene_destroy(&scene);
}

static void test_refusals_say_where(void **state)
{
    (void)state;
    static const struct {
        const char *rest;
        const char *words;
    } CASES[] = {
        {QUAD_VIEW ",\"nodes\":[{\"mesh\":3}]", "nodes[0].mesh"},
        {"\"nodes\":[{\"children\":[1]},{\"children\":[0]}]", "descendants"},
        {"\"nodes\":[{\"children\":[1,1]},{}]", "twice"},
        {"\"extensionsRequired\":[\"EXT_made_up\"]", "EXT_made_up"},
        {"\"bufferViews\":[{\"buffer\":0,\"byteOffset\":40,\"byteLength\":20}]", "bufferViews[0]"},
        {"\"images\":[{\"uri\":7}]", "images[0].uri"},
        {"\"scene\":1,\"scenes\":[{}]", "allowed are 0 to 0"},
    };
    for (size_t i = 0; i < sizeof(CASES) / sizeof(CASES[0]); i++) {
        struct error error = {{0}};
        assert_null(import_text(QUAD, sizeof(QUAD), CASES[i].rest, &error));
        if (!strstr(error.message, CASES[i].words)) {
            fail_msg("'%s' does not say '%s'", error.message, CASES[i].words);
        }
    }
}

// Tangents stored in a model against those made from its UVs: this fixes the sign conventions.
static void test_tangents_agree_with_stored_ones(void **state)
{
    (void)state;
    static const char *const MODELS[] = {"khronos/Avocado/Avocado.glb",
                                         "khronos/WaterBottle/WaterBottle.glb"};
    for (size_t i = 0; i < sizeof(MODELS) / sizeof(MODELS[0]); i++) {
        const char *path = support_scene_path(MODELS[i]);
        if (!path) {
            skip();
        }
        struct error error;
        struct scene *scene = scene_import_gltf(path, &error);
        assert_non_null(scene);
        uint32_t agreeing = support_count_agreeing_tangents(scene);
        // Stored ones may come from another tool than Mikkelsen's reference code.
        assert_true(agreeing > scene->index_count * 9 / 10);
        scene_destroy(&scene);
    }
}

static bool may_be_refused(const char *path)
{
    return strstr(path, "Draco") || strstr(path, "Meshopt") || strstr(path, "Ktx2Etc1s");
}

static uint32_t check_folder(const char *folder)
{
    uint32_t count = 0;
    DIR *directory = opendir(folder);
    assert_non_null(directory);
    for (struct dirent *entry; (entry = readdir(directory));) {
        char path[4096];
        snprintf(path, sizeof(path), "%s/%s", folder, entry->d_name);
        if (entry->d_type == DT_DIR && entry->d_name[0] != '.') {
            count += check_folder(path);
        }
        if (!strstr(entry->d_name, ".gl")) {
            continue;
        }
        struct error error = {{0}};
        struct scene *scene = scene_import_gltf(path, &error);
        if (!scene && !may_be_refused(path)) {
            fail_msg("%s", error.message);
        }
        if (scene) {
            support_check_scene(scene);
            scene_destroy(&scene);
            count++;
        }
    }
    closedir(directory);
    return count;
}

static void test_sample_folders(void **state)
{
    (void)state;
    const char *path = support_scene_path("khronos");
    if (!path) {
        skip();
    }
    assert_true(check_folder(path) > 30);
    path = support_scene_path("features");
    assert_non_null(path);
    assert_true(check_folder(path) > 10);
}

static void test_sponza_counts(void **state)
{
    (void)state;
    const char *path = support_scene_path("sponza/sponza.glb");
    if (!path) {
        skip();
    }
    struct error error;
    struct scene *scene = scene_import_gltf(path, &error);
    assert_non_null(scene);
    assert_int_equal(scene_triangle_count(scene), 262087);
    assert_int_equal(scene->image_count, 49);
    assert_int_equal(scene->camera_count, 4);
    assert_int_equal(scene->light_count, 1);
    assert_int_equal(scene->lights[0].type, SCENE_LIGHT_DIRECTIONAL);
    scene_destroy(&scene);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_primitive_modes),
        cmocka_unit_test(test_strip_winding),
        cmocka_unit_test(test_accessor_kinds),
        cmocka_unit_test(test_nodes_lights_cameras),
        cmocka_unit_test(test_materials),
        cmocka_unit_test(test_animation),
        cmocka_unit_test(test_refusals_say_where),
        cmocka_unit_test(test_tangents_agree_with_stored_ones),
        cmocka_unit_test(test_sample_folders),
        cmocka_unit_test(test_sponza_counts),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
