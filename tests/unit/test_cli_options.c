// Proves that the offline tool's options reach their targets, and that values out of range are
// refused with the usage status: each line is parsed as a command would parse it.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "server/tool/cli.h"
#include "server/tool/cli_bench.h"
#include "server/tool/shot_options.h"

struct values {
    struct cli_shot_options shot;
    struct cli_parser parser;
    const char *out;
    bool json;
    uint32_t frames;
    double noise;
};

#define MAX_WORDS 32

// Parses a line whose words are separated by single spaces; the texts live as long as `line`.
static bool parse(struct values *values, char *line, int *out_status)
{
    char *words[MAX_WORDS + 1] = {"test"};
    int count = 1;
    for (char *word = strtok(line, " "); word; word = strtok(NULL, " ")) {
        assert_true(count < MAX_WORDS);
        words[count++] = word;
    }
    *values = (struct values){.shot.size = {640, 360}, .frames = 7};
    values->parser = (struct cli_parser){.command = "test", .usage = "", .max_arguments = 2};
    cli_take_shot(&values->parser, &values->shot);
    cli_take_text(&values->parser, "out", &values->out);
    cli_take_flag(&values->parser, "json", &values->json);
    cli_take_count(&values->parser, "frames", 1, 100, &values->frames);
    cli_take_number(&values->parser, "until-noise", 0.001, 1.0, &values->noise);
    return cli_parse(&values->parser, count, words, out_status);
}

static void test_values_arrive(void **state)
{
    (void)state;
    struct values values;
    int status;
    char line[] = "a.glb --size 32x18 --eye 1,2.5,-3 --target 0,0,0 --fov-y-deg 45 --set a.b=1 "
                  "--set c= --gi grid --preset high --view direct --json --frames 100 b.glb "
                  "--out=x.png --until-noise 0.5 --gpu 1";
    assert_true(parse(&values, line, &status));
    assert_int_equal(values.parser.argument_count, 2);
    assert_string_equal(values.parser.arguments[0], "a.glb");
    assert_string_equal(values.parser.arguments[1], "b.glb");
    assert_int_equal(values.shot.size.width, 32);
    assert_int_equal(values.shot.size.height, 18);
    assert_true(values.shot.camera.eye.given && values.shot.camera.target.given);
    assert_false(values.shot.camera.up.given);
    assert_true(values.shot.camera.eye.xyz[1] == 2.5f && values.shot.camera.eye.xyz[2] == -3.0f);
    assert_true(values.shot.camera.fov_y_deg == 45.0);
    assert_int_equal(values.shot.settings.sets.count, 2);
    assert_string_equal(values.shot.settings.sets.values[1], "c=");
    assert_int_equal(values.shot.settings.gi, GI_METHOD_GRID);
    assert_int_equal(values.shot.settings.preset, QUALITY_HIGH);
    assert_int_equal(values.shot.settings.view, DEBUG_VIEW_DIRECT);
    assert_string_equal(values.shot.gpu, "1");
    assert_string_equal(values.out, "x.png");
    assert_true(values.json && values.frames == 100 && values.noise == 0.5);
}

static void test_defaults_stay(void **state)
{
    (void)state;
    struct values values;
    int status;
    char line[] = "";
    assert_true(parse(&values, line, &status));
    assert_int_equal(values.parser.argument_count, 0);
    assert_int_equal(values.shot.size.width, 640);
    assert_int_equal(values.frames, 7);
    assert_int_equal(values.shot.settings.gi, CLI_NO_CHOICE);
    assert_string_equal(values.shot.gpu, "auto");
    assert_null(values.out);
    assert_false(values.json);
}

static void test_wrong_values_are_refused(void **state)
{
    (void)state;
    static const char *const lines[] = {
        "a b c",          "--bogus",           "--out",         "--size 0x9",
        "--size 4097x1",  "--size 12x12x",     "--frames 0",    "--frames 1.5",
        "--frames 101",   "--frames nan",      "--frames 3x",   "--eye 1,2",
        "--eye 1,2,inf",  "--until-noise 2",   "--gi lpv",      "--preset best",
        "--view nothing", "--fov-y-deg 179.5", "--set novalue", "--until-noise nan",
    };
    for (size_t i = 0; i < sizeof(lines) / sizeof(lines[0]); i++) {
        struct values values;
        char line[64];
        int status = 0;
        snprintf(line, sizeof(line), "%s", lines[i]);
        if (parse(&values, line, &status) || status != CLI_EXIT_USAGE)
            fail_msg("\"%s\" ends with status %d", lines[i], status);
    }
}

static void test_help_ends_without_error(void **state)
{
    (void)state;
    struct values values;
    int status = 9;
    char line[] = "--frames 3 --help";
    assert_false(parse(&values, line, &status));
    assert_int_equal(status, 0);
}

static void test_camera_is_chosen(void **state)
{
    (void)state;
    struct error error = {""};
    struct scene *scene = scene_load("builtin:cornell", &error);
    assert_non_null(scene);
    struct view_camera camera, first;
    struct cli_camera options = {.fov_y_deg = 90.0};
    shot_default_camera(scene, 1.0f, &first);
    assert_true(cli_camera_choose(&options, scene, 1.0f, &camera, &error));
    assert_true(camera.eye[2] == first.eye[2]);
    assert_float_equal(camera.fov_y_rad, 1.5707963f, 1e-6f);
    options = (struct cli_camera){.eye = {true, {1, 2, 3}}, .target = {true, {0, 0, 0}}};
    assert_true(cli_camera_choose(&options, scene, 1.0f, &camera, &error));
    assert_true(camera.eye[0] == 1.0f && camera.up[1] == 1.0f);
    options.target.given = false;
    assert_false(cli_camera_choose(&options, scene, 1.0f, &camera, &error));
    assert_non_null(strstr(error.message, "--target"));
    options = (struct cli_camera){.name = "nowhere"};
    assert_false(cli_camera_choose(&options, scene, 1.0f, &camera, &error));
    assert_non_null(strstr(error.message, "nowhere"));
    scene_destroy(&scene);
}

// The reference draws only where the camera rests: a measurement of a moving one would never end.
static void test_moving_reference_is_refused(void **state)
{
    (void)state;
    char command[] = "effects", option[] = "--gi", method[] = "reference";
    char *arguments[] = {command, option, method, NULL};
    assert_int_equal(bench_effects(3, arguments), CLI_EXIT_USAGE);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_values_arrive),
        cmocka_unit_test(test_defaults_stay),
        cmocka_unit_test(test_wrong_values_are_refused),
        cmocka_unit_test(test_help_ends_without_error),
        cmocka_unit_test(test_camera_is_chosen),
        cmocka_unit_test(test_moving_reference_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
