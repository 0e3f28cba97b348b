// Proves which source of an option wins and that wrong options are named: reads command lines,
// environments and a file.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "server/options.h"

static enum options_result read_all(char *const *arguments, char *const *environment,
                                    struct options *options, struct error *error)
{
    int count = 0;
    while (arguments[count])
        count++;
    return options_read(count, arguments, environment, options, error);
}

static void flags_win_then_environment_then_file(void **state)
{
    (void)state;
    char path[] = "/tmp/voxcast-options-XXXXXX";
    int descriptor = mkstemp(path);
    assert_true(descriptor >= 0);
    dprintf(descriptor, "# a comment\n\nport = 1001\nmax-clients = 3\n jpeg-quality=50 \n");
    close(descriptor);
    char *arguments[] = {"voxcastd", "room.glb", "--config", path, "--port=1003", NULL};
    char *environment[] = {"HOME=/", "VOXCASTD_PORT=1002", "VOXCASTD_MAX_CLIENTS=4", NULL};
    struct options options;
    struct error error = {""};
    enum options_result result = read_all(arguments, environment, &options, &error);
    unlink(path);
    if (result != OPTIONS_RUN)
        fail_msg("%s", error.message);
    assert_string_equal(options.scene, "room.glb");
    assert_int_equal(options.port, 1003);
    assert_int_equal(options.max_clients, 4);
    assert_int_equal(options.jpeg_quality, 50);
    assert_string_equal(options.listen, "127.0.0.1");
}

static void refuse(char *argument, char *value, char *variable, const char *message)
{
    char *arguments[] = {"voxcastd", argument, value, NULL};
    char *environment[] = {variable, NULL};
    struct options options;
    struct error error = {""};
    assert_int_equal(read_all(arguments, environment, &options, &error), OPTIONS_WRONG);
    if (!strstr(error.message, message))
        fail_msg("\"%s\" lacks \"%s\"", error.message, message);
}

static void unreadable_files_are_named(void **state)
{
    (void)state;
    char path[] = "/tmp/voxcast-options-XXXXXX";
    int descriptor = mkstemp(path);
    assert_true(descriptor >= 0);
    dprintf(descriptor, "port = 1001\nscene = %02000d\n", 0);
    close(descriptor);
    refuse("--config", path, NULL, ":2: longer than");
    unlink(path);
    refuse("--config", "/tmp", NULL, "config file /tmp: Is a directory");
}

static void wrong_options_are_named(void **state)
{
    (void)state;
    refuse("--frob", "1", NULL, "unknown option --frob");
    refuse("-x", NULL, NULL, "unknown option -x");
    refuse("--port", "99999", NULL, "allowed are 0 to 65535");
    refuse("--port", "-1", NULL, "allowed are 0 to 65535");
    refuse("--port", NULL, NULL, "wants a value");
    refuse("--log-level", "loud", NULL, "error, warn, info, debug");
    refuse("--config", "/nonexistent/file", NULL, "config file");
    refuse(NULL, NULL, "VOXCASTD_FROB=1", "unknown option VOXCASTD_FROB");
    refuse(NULL, NULL, "VOXCASTD_MAX_CLIENTS=0", "allowed are 1 to 64");
}

static void help_names_every_option(void **state)
{
    (void)state;
    char *arguments[] = {"voxcastd", "--help", NULL};
    struct options options;
    struct error error;
    assert_int_equal(read_all(arguments, NULL, &options, &error), OPTIONS_HELP);
    arguments[1] = "--version";
    assert_int_equal(read_all(arguments, NULL, &options, &error), OPTIONS_VERSION);
    char help[8192];
    options_write_help(help, sizeof(help));
    assert_true(strlen(help) < sizeof(help) - 1);
    assert_non_null(strstr(help, "--allow-origin"));
    assert_non_null(strstr(help, "--log-level"));
    assert_non_null(strstr(help, "--version"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(flags_win_then_environment_then_file),
        cmocka_unit_test(unreadable_files_are_named),
        cmocka_unit_test(wrong_options_are_named),
        cmocka_unit_test(help_names_every_option),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
