// Proves that broken and hostile scene files are refused with a message or loaded sanitized, as the
// folder's manifest says, without crash or hang and in bounded memory. Each file is loaded in a
// child process with an alarm. The child reports by its exit status; the parent reads its peak
// memory (not under sanitizers, which need memory of their own).
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include <cjson/cJSON.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "renderer/image/file_access.h"
#include "renderer/scene/ray_scene.h"
#include "renderer/import/importers.h"
#include "support_scenes.h"

#define TIME_LIMIT_S    10
#define MEMORY_LIMIT_KB (1l << 20)

#if !defined(__has_feature)
#define __has_feature(feature) 0
#endif
#if __has_feature(address_sanitizer) || defined(__SANITIZE_ADDRESS__) ||                           \
    defined(__SANITIZE_THREAD__)
#define UNDER_SANITIZER 1
#else
#define UNDER_SANITIZER 0
#endif

enum child_status { CHILD_ACCEPTED = 0, CHILD_REJECTED = 10, CHILD_NO_MESSAGE = 11 };

// Loads the file, checks the scene, and casts rays, so that wrong data has a chance to do harm.
static int load_in_child(const char *path)
{
    struct error error = {{0}};
    const struct importer *importer = importer_of(path);
    assert_non_null(importer);
    alarm(TIME_LIMIT_S);
    struct scene *scene = importer->file(path, &error);
    if (!scene) {
        return strlen(error.message) > 10 ? CHILD_REJECTED : CHILD_NO_MESSAGE;
    }
    support_check_scene(scene);
    struct ray_scene *ray_scene = ray_scene_create(scene);
    assert_non_null(ray_scene);
    struct ray_hit hit;
    ray_scene_intersect(ray_scene, (float[3]){0.5f, 0.25f, 5}, (float[3]){0, 0, -1}, 100, &hit);
    ray_scene_destroy(&ray_scene);
    scene_destroy(&scene);
    return CHILD_ACCEPTED;
}

static bool is_expected(const cJSON *entry, const char *outcome)
{
    const char *expect = cJSON_GetStringValue(cJSON_GetObjectItem(entry, "expect"));
    const char *also_ok = cJSON_GetStringValue(cJSON_GetObjectItem(entry, "also_ok"));
    return strcmp(expect, outcome) == 0 || (also_ok && strcmp(also_ok, outcome) == 0);
}

// False, with a line that says why, if the result is not what the manifest says.
static bool check_file(const char *folder, const cJSON *entry)
{
    char path[4096];
    const char *name = cJSON_GetStringValue(cJSON_GetObjectItem(entry, "file"));
    snprintf(path, sizeof(path), "%s/%s", folder, name);
    fflush(NULL);
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        _exit(load_in_child(path));
    }
    int status;
    struct rusage usage;
    assert_int_equal(wait4(child, &status, 0, &usage), child);
    if (!WIFEXITED(status)) {
        printf("%s: killed by signal %d\n", name, WTERMSIG(status));
        return false;
    }
    if (!UNDER_SANITIZER && usage.ru_maxrss > MEMORY_LIMIT_KB) {
        printf("%s: used %ld KiB\n", name, usage.ru_maxrss);
        return false;
    }
    bool accepted = WEXITSTATUS(status) == CHILD_ACCEPTED;
    bool rejected = WEXITSTATUS(status) == CHILD_REJECTED;
    if ((accepted && is_expected(entry, "accept-sanitised")) ||
        (rejected && is_expected(entry, "reject"))) {
        return true;
    }
    printf("%s: exit status %d, expected %s\n", name, WEXITSTATUS(status),
           cJSON_GetStringValue(cJSON_GetObjectItem(entry, "expect")));
    return false;
}

static void test_manifest(void **state)
{
    (void)state;
    const char *path = support_scene_path("hostile/manifest.json");
    if (!path) {
        skip();
    }
    uint8_t *bytes;
    size_t size;
    assert_true(asset_read_file(path, 1 << 20, &bytes, &size, NULL, NULL));
    cJSON *manifest = cJSON_Parse((const char *)bytes);
    free(bytes);
    assert_non_null(manifest);
    char *folder = asset_path_folder(path);
    uint32_t file_count = 0;
    uint32_t wrong_count = 0;
    const cJSON *entry;
    cJSON_ArrayForEach(entry, cJSON_GetObjectItem(manifest, "files"))
    {
        file_count++;
        wrong_count += !check_file(folder, entry);
    }
    free(folder);
    cJSON_Delete(manifest);
    assert_true(file_count > 100);
    assert_int_equal(wrong_count, 0);
}

static void test_names_stay_in_the_folder(void **state)
{
    (void)state;
    char folder[] = "/tmp/voxcast-path-XXXXXX";
    assert_non_null(mkdtemp(folder));
    char link[4096];
    snprintf(link, sizeof(link), "%s/link", folder);
    assert_int_equal(symlink("/etc", link), 0);
    static const char *const NAMES[] = {
        "../x", "/etc/passwd", "link/passwd", "file:///etc/passwd", "http://h/x", "a\\..\\b",
        "",     "a\nb",        "missing",
    };
    for (size_t i = 0; i < sizeof(NAMES) / sizeof(NAMES[0]); i++) {
        struct error error = {{0}};
        assert_null(asset_path_resolve(folder, NAMES[i], &error));
        assert_true(strlen(error.message) > 0);
    }
    unlink(link);
    rmdir(folder);
    char escaped[] = "a%20b%2Fc";
    assert_true(asset_path_decode_percent(escaped));
    assert_string_equal(escaped, "a b/c");
    char nul[] = "a%00b", broken[] = "a%2";
    assert_false(asset_path_decode_percent(nul));
    assert_false(asset_path_decode_percent(broken));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_manifest),
        cmocka_unit_test(test_names_stay_in_the_folder),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
