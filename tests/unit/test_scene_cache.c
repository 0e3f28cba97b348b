// Proves that the scene cache returns what was written, under its key alone; that files which are
// truncated, damaged in any byte, of the wrong kind or forged are left unread and replaced; that it
// keeps to its limit and removes what was used least recently; and that processes share a folder.
// Works in folders of its own in the working folder.
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include <dirent.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "renderer/cache/scene_cache.h"

#define CONTENT_BYTES 200u
#define MAX_BYTES     (16u << 20)

static char home[64], folder[128];

static int make_folder(void **state)
{
    (void)state;
    strcpy(home, "scene_cache.XXXXXX");
    assert_non_null(mkdtemp(home));
    char path[4096];
    assert_non_null(realpath(home, path));
    assert_int_equal(setenv("XDG_CACHE_HOME", path, 1), 0);
    snprintf(folder, sizeof(folder), "%s/voxcast/scenes", home);
    scene_cache_open(16);
    assert_true(scene_cache_is_open());
    return 0;
}

static int remove_folder(void **state)
{
    (void)state;
    scene_cache_open(0);
    char command[128];
    snprintf(command, sizeof(command), "rm -rf '%s'", home);
    return system(command);
}

static struct cache_key key_of(uint32_t number)
{
    struct cache_key key = cache_key_start("test", 1);
    cache_key_add(&key, &number, sizeof(number));
    return key;
}

// Bytes that differ by key, also from their neighbours.
static void fill(uint8_t *bytes, size_t size, uint32_t number)
{
    for (size_t i = 0; i < size; i++)
        bytes[i] = (uint8_t)(number * 31 + i * 7 + (i >> 8));
}

static void put(uint32_t number, size_t size)
{
    uint8_t *bytes = malloc(size + 1);
    assert_non_null(bytes);
    fill(bytes, size, number);
    struct cache_key key = key_of(number);
    scene_cache_write(&key, bytes, size);
    free(bytes);
}

// Whether the entry is there; fails if it is there and wrong.
static bool holds(uint32_t number, size_t expected)
{
    struct cache_key key = key_of(number);
    size_t size = 0;
    uint8_t *bytes = scene_cache_read(&key, MAX_BYTES, &size);
    if (!bytes)
        return false;
    uint8_t *wanted = malloc(expected + 1);
    assert_non_null(wanted);
    fill(wanted, expected, number);
    assert_int_equal(size, expected);
    assert_memory_equal(bytes, wanted, expected);
    free(wanted);
    free(bytes);
    return true;
}

// Path of the folder's only file.
static void find_file(char out_path[512])
{
    DIR *stream = opendir(folder);
    assert_non_null(stream);
    uint32_t count = 0;
    for (struct dirent *it; (it = readdir(stream));)
        if (it->d_name[0] != '.' && ++count == 1)
            snprintf(out_path, 512, "%s/%s", folder, it->d_name);
    closedir(stream);
    assert_int_equal(count, 1);
}

static uint32_t count_files(uint64_t *out_bytes)
{
    DIR *stream = opendir(folder);
    assert_non_null(stream);
    uint32_t count = 0;
    *out_bytes = 0;
    for (struct dirent *it; (it = readdir(stream));) {
        struct stat status;
        if (it->d_name[0] == '.' || fstatat(dirfd(stream), it->d_name, &status, 0) != 0)
            continue;
        count++;
        *out_bytes += (uint64_t)status.st_size;
    }
    closedir(stream);
    return count;
}

static void write_file(const char *path, const uint8_t *bytes, size_t size)
{
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    fclose(file);
}

static void test_returns_what_was_written(void **state)
{
    (void)state;
    assert_false(holds(1, CONTENT_BYTES));
    put(1, CONTENT_BYTES);
    put(2, 0);
    put(3, 300001);
    assert_true(holds(1, CONTENT_BYTES) && holds(2, 0) && holds(3, 300001));
    assert_false(holds(4, CONTENT_BYTES));
    put(1, CONTENT_BYTES); // again
    assert_true(holds(1, CONTENT_BYTES));
    struct cache_key key = key_of(3);
    size_t size;
    assert_null(scene_cache_read(&key, 300000, &size)); // more than the reader can take
    assert_true(holds(3, 300001));                      // but others may
}

static void test_keys_tell_all_bytes_apart(void **state)
{
    (void)state;
    uint8_t bytes[67] = {0};
    struct cache_key keys[2 + 8 * sizeof(bytes)];
    uint32_t count = 0;
    keys[count] = cache_key_start("test", 1);
    cache_key_add(&keys[count++], bytes, sizeof(bytes));
    keys[count] = cache_key_start("test", 1);
    cache_key_add(&keys[count++], bytes, sizeof(bytes) - 1);
    for (uint32_t i = 0; i < 8 * sizeof(bytes); i++) {
        bytes[i / 8] ^= (uint8_t)(1u << i % 8);
        keys[count] = cache_key_start("test", 1);
        cache_key_add(&keys[count++], bytes, sizeof(bytes));
        bytes[i / 8] ^= (uint8_t)(1u << i % 8);
    }
    for (uint32_t i = 0; i < count; i++)
        for (uint32_t j = 0; j < i; j++)
            for (int word = 0; word < 2; word++)
                assert_true(keys[i].words[word] != keys[j].words[word]);
    struct cache_key other = cache_key_start("test", 2), kind = cache_key_start("tes", 1);
    struct cache_key first = cache_key_start("test", 1);
    assert_memory_not_equal(&first, &other, sizeof(first));
    assert_memory_not_equal(&first, &kind, sizeof(first));
}

// Each file that differs from the right one is left unread, removed, and can be written again.
static void expect_refused(const char *path, const uint8_t *bytes, size_t size)
{
    write_file(path, bytes, size);
    uint64_t invalid = scene_cache_get_statistics().invalid;
    assert_false(holds(7, CONTENT_BYTES));
    assert_int_equal(scene_cache_get_statistics().invalid, invalid + 1);
    assert_int_equal(access(path, F_OK), -1);
}

static void test_refuses_damaged_files(void **state)
{
    (void)state;
    char path[512];
    uint8_t good[SCENE_CACHE_HEADER_BYTES + CONTENT_BYTES], bytes[sizeof(good) + 1];
    put(7, CONTENT_BYTES);
    find_file(path);
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    assert_int_equal(fread(good, 1, sizeof(good), file), sizeof(good));
    assert_int_equal(fgetc(file), EOF);
    fclose(file);
    for (size_t i = 0; i < 8 * sizeof(good); i++) {
        memcpy(bytes, good, sizeof(good));
        bytes[i / 8] ^= (uint8_t)(1u << i % 8);
        expect_refused(path, bytes, sizeof(good));
    }
    for (size_t size = 0; size < sizeof(good); size++)
        expect_refused(path, good, size);
    memcpy(bytes, good, sizeof(good));
    bytes[sizeof(good)] = 0;
    expect_refused(path, bytes, sizeof(bytes));
    // Ranges of zeros, as a crash may leave them, and of ones.
    for (size_t from = 0; from < sizeof(good); from += 8)
        for (int value = 0; value < 256; value += 255) {
            memcpy(bytes, good, sizeof(good));
            memset(bytes + from, value, 16 < sizeof(good) - from ? 16 : sizeof(good) - from);
            if (memcmp(bytes, good, sizeof(good)) != 0)
                expect_refused(path, bytes, sizeof(good));
        }
    put(7, CONTENT_BYTES);
    assert_true(holds(7, CONTENT_BYTES));
}

static void test_refuses_what_is_no_file_of_its_own(void **state)
{
    (void)state;
    char path[512], other[512];
    put(7, CONTENT_BYTES);
    find_file(path);
    // Another entry's valid file under this name.
    snprintf(other, sizeof(other), "%s/other", home);
    assert_int_equal(rename(path, other), 0);
    put(8, CONTENT_BYTES);
    char wrong[512];
    find_file(wrong);
    assert_int_equal(rename(wrong, path), 0);
    assert_false(holds(7, CONTENT_BYTES));
    // A link, a folder, and a pipe without a writer, which must not block.
    assert_int_equal(symlink("../../other", path), 0);
    assert_false(holds(7, CONTENT_BYTES));
    assert_int_equal(access(other, F_OK), 0);
    assert_int_equal(mkfifo(path, 0600), 0);
    assert_false(holds(7, CONTENT_BYTES));
    assert_int_equal(mkdir(path, 0700), 0);
    assert_false(holds(7, CONTENT_BYTES));
    put(7, CONTENT_BYTES); // cannot take the folder's place
    assert_false(holds(7, CONTENT_BYTES));
    assert_int_equal(rmdir(path), 0);
    put(7, CONTENT_BYTES);
    assert_true(holds(7, CONTENT_BYTES));
}

static void test_keeps_to_its_limit(void **state)
{
    (void)state;
    enum { ENTRY_BYTES = 100 << 10, COUNT = 40 };
    uint64_t bytes;
    scene_cache_open(1);
    for (uint32_t i = 0; i < COUNT; i++) {
        put(i, ENTRY_BYTES);
        usleep(2000); // so that times of use differ
        // The first one is used again and again.
        assert_true(holds(0, ENTRY_BYTES));
        assert_true(holds(i, ENTRY_BYTES));
        assert_in_range(count_files(&bytes), 1, 10);
        assert_in_range(bytes, 1, 1 << 20);
    }
    assert_true(holds(COUNT - 2, ENTRY_BYTES));
    assert_false(holds(1, ENTRY_BYTES));
    put(COUNT, 2u << 20); // larger than all may be
    assert_false(holds(COUNT, 2u << 20));
    assert_true(holds(0, ENTRY_BYTES));
    assert_int_equal(count_files(&bytes), 9);
}

static void test_is_off(void **state)
{
    (void)state;
    put(1, CONTENT_BYTES);
    scene_cache_open(0);
    assert_false(scene_cache_is_open());
    assert_false(holds(1, CONTENT_BYTES));
    put(2, CONTENT_BYTES);
    scene_cache_open(16);
    assert_true(holds(1, CONTENT_BYTES));
    assert_false(holds(2, CONTENT_BYTES));
    // Where no folder can be made, the cache is off, and nothing else happens.
    char path[160];
    snprintf(path, sizeof(path), "%s/file", home);
    write_file(path, (const uint8_t *)"", 0);
    char *before = strdup(getenv("XDG_CACHE_HOME"));
    setenv("XDG_CACHE_HOME", realpath(path, (char[4096]){0}), 1);
    scene_cache_open(16);
    assert_false(scene_cache_is_open());
    setenv("XDG_CACHE_HOME", before, 1);
    free(before);
}

static void test_forgets_abandoned_files(void **state)
{
    (void)state;
    char path[160];
    uint64_t bytes;
    snprintf(path, sizeof(path), "%s/1-1.tmp", folder);
    write_file(path, (const uint8_t *)"half", 4);
    struct timespec old[2] = {{1000000000, 0}, {1000000000, 0}};
    assert_int_equal(utimensat(AT_FDCWD, path, old, 0), 0);
    snprintf(path, sizeof(path), "%s/1-2.tmp", folder);
    write_file(path, (const uint8_t *)"new", 3);
    put(1, CONTENT_BYTES);
    assert_int_equal(count_files(&bytes), 2);
    assert_int_equal(access(path, F_OK), 0);
}

// Writes, reads and evicts the same entries as the other processes do.
static void work(uint32_t seed)
{
    enum { ENTRY_BYTES = 150 << 10, KEYS = 12 };
    scene_cache_open(1);
    uint32_t hits = 0;
    for (uint32_t i = 0; i < 300; i++) {
        uint32_t number = (i * 7 + seed * 5 + i / 11) % KEYS;
        if (holds(number, ENTRY_BYTES + number))
            hits++;
        else
            put(number, ENTRY_BYTES + number);
    }
    assert_true(hits > 0);
}

static void test_many_processes_use_one_folder(void **state)
{
    (void)state;
    pid_t children[4];
    uint64_t invalid = scene_cache_get_statistics().invalid;
    for (uint32_t i = 0; i < 4; i++) {
        children[i] = fork();
        assert_true(children[i] >= 0);
        if (children[i] == 0) {
            work(i);
            // Without cmocka's end of a group: only the parent reports.
            _exit(scene_cache_get_statistics().invalid == invalid ? 0 : 1);
        }
    }
    for (uint32_t i = 0; i < 4; i++) {
        int status = 0;
        assert_int_equal(waitpid(children[i], &status, 0), children[i]);
        assert_true(WIFEXITED(status));
        assert_int_equal(WEXITSTATUS(status), 0);
    }
    uint64_t bytes;
    assert_in_range(count_files(&bytes), 1, 12);
}

int main(void)
{
#define TEST(name) cmocka_unit_test_setup_teardown(name, make_folder, remove_folder)
    const struct CMUnitTest tests[] = {
        TEST(test_returns_what_was_written), TEST(test_keys_tell_all_bytes_apart),
        TEST(test_refuses_damaged_files),    TEST(test_refuses_what_is_no_file_of_its_own),
        TEST(test_keeps_to_its_limit),       TEST(test_is_off),
        TEST(test_forgets_abandoned_files),  TEST(test_many_processes_use_one_folder),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
