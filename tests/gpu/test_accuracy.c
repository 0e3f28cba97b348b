// Proves voxcast accuracy: sweeps are read or refused with a reason, the Pareto front is right for
// made-up results, and a small run writes its files, keeps them, and continues where it was
// stopped.
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cjson/cJSON.h>
#include <cmocka.h>

#include "server/accuracy/accuracy.h"
#include "server/tool/cli.h"

static char folder[] = "/tmp/voxcast-accuracy-XXXXXX";

static void name_file(char path[256], const char *name)
{
    snprintf(path, 256, "%s/%s", folder, name);
}

static void write_file(const char *name, const char *text)
{
    char path[256];
    name_file(path, name);
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_true(fputs(text, file) >= 0);
    assert_int_equal(fclose(file), 0);
}

static cJSON *read_results(void)
{
    char path[256];
    name_file(path, "results.json");
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    char *text = calloc(1, 1 << 20);
    assert_non_null(text);
    assert_true(fread(text, 1, (1 << 20) - 1, file) > 0);
    fclose(file);
    cJSON *json = cJSON_Parse(text);
    free(text);
    assert_non_null(json);
    return json;
}

static const cJSON *at(const cJSON *json, const char *name)
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(json, name);
    if (!item)
        fail_msg("there is no \"%s\"", name);
    return item;
}

static void test_named_sweeps(void **state)
{
    (void)state;
    struct sweep *sweep = malloc(sizeof(*sweep));
    struct error error = {""};
    assert_non_null(sweep);
    assert_true(sweep_load("quick", sweep, &error));
    assert_int_equal(sweep->configuration_count, 1 + QUALITY_COUNT);
    if (!sweep_load("full", sweep, &error))
        fail_msg("%s", error.message);
    assert_int_equal(sweep->configuration_count, 52);
    for (uint32_t i = 0; i < sweep->configuration_count; i++)
        for (uint32_t k = 0; k < i; k++)
            assert_string_not_equal(sweep->configurations[i].name, sweep->configurations[k].name);
    free(sweep);
}

static void test_sweeps_in_files(void **state)
{
    (void)state;
    struct sweep *sweep = malloc(sizeof(*sweep));
    struct error error = {""};
    char path[256];
    assert_non_null(sweep);
    write_file("sweep.json", "[{\"name\": \"a\", \"preset\": \"draft\", \"scale\": 0.5, \"set\": "
                             "{\"cone_set\": 16, \"settings.soft_shadows\": false}}]");
    name_file(path, "sweep.json");
    if (!sweep_load(path, sweep, &error))
        fail_msg("%s", error.message);
    struct frame_params params = {0};
    render_settings_init(&params.settings);
    assert_true(configuration_apply(&sweep->configurations[0], &params, &error));
    assert_int_equal(params.quality, QUALITY_DRAFT);
    assert_int_equal(params.settings.cone_set, CONE_SET_16);
    assert_false(params.settings.soft_shadows);
    static const char *const wrong[][2] = {
        {"", "no JSON"},
        {"[]", "array of configurations"},
        {"[{}]", "name"},
        {"[{\"name\": \"../a\"}]", "../a"},
        {"[{\"name\": \"a\", \"preset\": \"best\"}]", "preset"},
        {"[{\"name\": \"a\", \"scale\": 3}]", "scale"},
        {"[{\"name\": \"a\", \"set\": {\"nothing\": 1}}]", "nothing"},
        {"[{\"name\": \"a\", \"set\": {\"lights.0.intensity\": 1}}]", "lights.0.intensity"},
        {"[{\"name\": \"a\", \"set\": {\"cone_step\": 99}}]", "cone_step"},
        {"[{\"name\": \"a\"}, {\"name\": \"a\"}]", "two configurations"},
    };
    for (size_t i = 0; i < sizeof(wrong) / sizeof(wrong[0]); i++) {
        write_file("sweep.json", wrong[i][0]);
        if (sweep_load(path, sweep, &error) || !strstr(error.message, wrong[i][1]))
            fail_msg("%s: \"%s\"", wrong[i][0], error.message);
    }
    assert_false(sweep_load("/no/such/file", sweep, &error));
    assert_non_null(strstr(error.message, "quick, full or a file"));
    free(sweep);
}

static cJSON *made_up_entry(const char *name, double ms, double flip, double ssim)
{
    cJSON *entry = cJSON_CreateObject();
    cJSON_AddStringToObject(entry, "name", name);
    cJSON_AddNumberToObject(cJSON_AddObjectToObject(entry, "frame_ms"), "median", ms);
    cJSON *metrics =
        cJSON_AddObjectToObject(cJSON_AddObjectToObject(entry, "converged"), "metrics");
    cJSON_AddNumberToObject(metrics, "ldr_flip", flip);
    cJSON_AddNumberToObject(metrics, "ssim", ssim);
    cJSON_AddNumberToObject(metrics, "energy_red", 1.0 - flip);
    return entry;
}

// Whether the configuration is on the front of the metric.
static bool is_marked(const cJSON *results, const char *name, const char *metric)
{
    const cJSON *entry, *item;
    cJSON_ArrayForEach(entry, at(results, "rungs"))
    {
        if (strcmp(at(entry, "name")->valuestring, name) != 0)
            continue;
        cJSON_ArrayForEach(item, at(entry, "pareto"))
        {
            if (strcmp(item->valuestring, metric) == 0)
                return true;
        }
    }
    return false;
}

static void test_pareto_front(void **state)
{
    (void)state;
    uint32_t kept;
    cJSON *results = results_open("/no/such/folder", cJSON_CreateObject(), &kept);
    assert_int_equal(kept, 0);
    results_add(results, made_up_entry("fast", 1.0, 0.5, 0.2));
    results_add(results, made_up_entry("good", 10.0, 0.1, 0.9));
    results_add(results, made_up_entry("slower", 20.0, 0.1, 0.95));
    results_add(results, made_up_entry("worse", 10.0, 0.3, 0.8));
    assert_true(is_marked(results, "fast", "ldr_flip"));
    assert_true(is_marked(results, "good", "ldr_flip"));
    assert_false(is_marked(results, "slower", "ldr_flip"));
    assert_false(is_marked(results, "worse", "ldr_flip"));
    assert_true(is_marked(results, "slower", "ssim"));
    // Too dark is as wrong as too bright.
    assert_true(is_marked(results, "good", "energy_red"));
    assert_false(is_marked(results, "slower", "energy_red"));
    // A configuration measured again replaces its old entry, and marks change.
    results_add(results, made_up_entry("fast", 1.0, 0.05, 0.99));
    assert_int_equal(cJSON_GetArraySize(at(results, "rungs")), 4);
    assert_false(is_marked(results, "good", "ldr_flip"));
    cJSON_Delete(results);
}

static int run_accuracy(const char *size)
{
    char sweep[256];
    name_file(sweep, "sweep.json");
    const char *const words[] = {"accuracy",        "builtin:cornell",
                                 "--out",           folder,
                                 "--ladder",        sweep,
                                 "--reference-spp", "16",
                                 "--size",          size,
                                 "--frames",        "1",
                                 "--edits",         "1"};
    char *arguments[16];
    int count = (int)(sizeof(words) / sizeof(words[0]));
    for (int i = 0; i < count; i++)
        arguments[i] = (char *)(uintptr_t)words[i];
    return cli_accuracy(count, arguments);
}

static void assert_file(const char *name)
{
    char path[256];
    struct stat status;
    name_file(path, name);
    if (stat(path, &status) != 0 || status.st_size == 0)
        fail_msg("%s is missing", name);
}

static void test_quality_table(void **state)
{
    (void)state;
    cJSON *table = accuracy_quality_table();
    assert_int_equal(cJSON_GetArraySize(table), QUALITY_COUNT);
    for (int i = 0; i < QUALITY_COUNT; i++) {
        const struct quality_level *level = &quality_levels[i];
        const cJSON *row = at(table, quality_names[i]);
        assert_true((float)at(row, "cone_step")->valuedouble == level->cone_step);
        assert_true((float)at(row, "specular_roughness")->valuedouble == level->specular_roughness);
        assert_int_equal(at(row, "shadow_taps")->valuedouble, level->shadow_taps);
        assert_string_equal(at(row, "gather_mode")->valuestring,
                            gather_mode_names[level->gather_mode]);
        assert_true(cJSON_IsTrue(at(row, "cone_shadows")) == level->cone_shadows);
    }
    cJSON_Delete(table);
}

static void test_a_run(void **state)
{
    (void)state;
    static const char *const files[] = {
        "results.json",   "results.csv",    "results.js",        "index.html",    "report.js",
        "error_chart.js", "chart_view.js",  "reference.pfm",     "reference.png", "none-strip.png",
        "half-error.png", "half-strip.png", "half-converged.png"};
    write_file("sweep.json", "[{\"name\": \"none\", \"set\": {\"gi_method\": \"none\"}}]");
    assert_int_equal(run_accuracy("48x27"), 0);
    // A second configuration is measured; the first is not measured again.
    cJSON *results = read_results();
    double first_ms =
        at(at(cJSON_GetArrayItem(at(results, "rungs"), 0), "frame_ms"), "median")->valuedouble;
    cJSON_Delete(results);
    write_file("sweep.json", "[{\"name\": \"none\", \"set\": {\"gi_method\": \"none\"}}, "
                             "{\"name\": \"half\", \"scale\": 0.5, \"preset\": \"draft\"}]");
    assert_int_equal(run_accuracy("48x27"), 0);
    for (size_t i = 0; i < sizeof(files) / sizeof(files[0]); i++)
        assert_file(files[i]);
    results = read_results();
    cJSON *table = accuracy_quality_table();
    assert_true(cJSON_Compare(at(at(results, "setup"), "quality"), table, true));
    cJSON_Delete(table);
    const cJSON *configurations = at(results, "rungs");
    assert_int_equal(cJSON_GetArraySize(configurations), 2);
    const cJSON *none = cJSON_GetArrayItem(configurations, 0),
                *half = cJSON_GetArrayItem(configurations, 1);
    assert_true(at(at(none, "frame_ms"), "median")->valuedouble == first_ms);
    // The method `none` has no indirect light; voxels have about as much as there should be.
    const cJSON *dark = at(at(none, "converged"), "indirect");
    const cJSON *lit = at(at(half, "converged"), "indirect");
    assert_true(fabs(at(dark, "energy_green")->valuedouble) < 0.01);
    assert_true(fabs(at(lit, "energy_green")->valuedouble - 1.0) < 0.02); // 0.011
    assert_true(at(lit, "rmse")->valuedouble < at(dark, "rmse")->valuedouble);
    assert_true(at(at(half, "edit"), "arrived_ms")->valuedouble > 0.0);
    assert_true(at(half, "memory_bytes")->valuedouble > 0.0);
    assert_true(at(at(half, "converged"), "settled")->type == cJSON_True);
    // The reference image of 16 samples errs, but less than an image without indirect light.
    const cJSON *noise = at(at(at(results, "noise"), "indirect"), "rmse");
    assert_true(at(noise, "reference")->valuedouble > 0.0);
    assert_true(at(noise, "reference")->valuedouble < 0.5 * at(dark, "rmse")->valuedouble);
    cJSON_Delete(results);
    // Another set-up starts anew.
    write_file("sweep.json", "[{\"name\": \"none\", \"set\": {\"gi_method\": \"none\"}}]");
    assert_int_equal(run_accuracy("32x18"), 0);
    results = read_results();
    assert_int_equal(cJSON_GetArraySize(at(results, "rungs")), 1);
    cJSON_Delete(results);
}

static void test_wrong_references(void **state)
{
    (void)state;
    struct error error = {""};
    struct picture picture;
    char path[256];
    assert_true(picture_init(&picture, 8, 8));
    name_file(path, "small.pfm");
    assert_true(picture_write_pfm(path, &picture, &error));
    picture_finish(&picture);
    struct shot shot = {.params = {.width = 16, .height = 9}};
    struct reference_image_params params = {.shot = &shot, .path = path};
    struct reference_image reference_image;
    assert_false(reference_image_get(&params, &reference_image, &error));
    assert_non_null(strstr(error.message, "8x8"));
    assert_non_null(strstr(error.message, "16x9"));
}

static int remove_folder(void **state)
{
    (void)state;
    char command[300];
    snprintf(command, sizeof(command), "rm -rf '%s'", folder);
    return system(command);
}

int main(void)
{
    if (!mkdtemp(folder))
        return 1;
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_named_sweeps),  cmocka_unit_test(test_sweeps_in_files),
        cmocka_unit_test(test_pareto_front),  cmocka_unit_test(test_wrong_references),
        cmocka_unit_test(test_quality_table), cmocka_unit_test(test_a_run),
    };
    return cmocka_run_group_tests(tests, NULL, remove_folder);
}
