// Proves that the scene cache changes no bit of an image: draws scenes without it, with it empty,
// with it filled, and with every file in it damaged, by frames that have not converged and by one
// that has, by one thread of the driver, so that frames are repeatable. Scenes have textures made
// by code and read from files. Also that a filled cache is used, that damage is noticed, and that
// entries forged with a right checksum do not bring the program down.
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <setjmp.h>
#include <cmocka.h>

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "renderer/image/image_cache.h"
#include "renderer/renderer.h"

#define WIDTH      64u
#define HEIGHT     36u
#define MAX_FRAMES 2000u

static char home[64];

static int make_folder(void **state)
{
    (void)state;
    strcpy(home, "scene_cache.XXXXXX");
    assert_non_null(mkdtemp(home));
    char path[4096];
    assert_non_null(realpath(home, path));
    return setenv("XDG_CACHE_HOME", path, 1);
}

static int remove_folder(void **state)
{
    (void)state;
    scene_cache_open(0);
    char command[128];
    snprintf(command, sizeof(command), "rm -rf '%s'", home);
    return system(command);
}

static void look_at_all(const struct scene *scene, struct view_camera *camera)
{
    double low[3], high[3];
    assert_true(scene_bounds(scene, low, high));
    for (int axis = 0; axis < 3; axis++) {
        camera->target[axis] = (float)(0.5 * (low[axis] + high[axis]));
        camera->eye[axis] = (float)(high[axis] + 0.5 * (high[axis] - low[axis]));
    }
    camera->up[1] = 1.0f;
}

// What to draw: so many frames, or 0 for as many as it takes to converge, which needs a BVH.
struct shot {
    const char *source;
    uint32_t frames;
};

// One for all: it takes 2 s to make programs.
static struct renderer *renderer;

// The linear image of the last frame. Nothing but programs is left of what was drawn before.
static float *draw(const struct shot *shot)
{
    struct render_settings settings;
    render_settings_init(&settings);
    if (shot->frames == 0)
        settings.bounces = 1; // so that it converges soon
    struct error error = {""};
    struct scene *scene = scene_load(shot->source, &error);
    if (!scene || !renderer_set_scene(renderer, scene, &error))
        fail_msg("%s", error.message);
    struct view *view = renderer_view_create(renderer);
    struct frame_params params = {.width = WIDTH,
                                  .height = HEIGHT,
                                  .quality = QUALITY_INTERACTIVE,
                                  .settings = settings,
                                  .output = FRAME_OUTPUT_LINEAR};
    params.camera.fov_y_rad = 0.9f;
    if (scene->camera_count > 0)
        scene_get_camera_placement(scene, 0, params.camera.eye, params.camera.target,
                                   params.camera.up);
    else
        look_at_all(scene, &params.camera);
    float *pixels = malloc((size_t)WIDTH * HEIGHT * 16);
    assert_non_null(pixels);
    uint32_t count = shot->frames ? shot->frames : MAX_FRAMES;
    for (uint32_t i = 0; i < count; i++) {
        struct frame_pixels frame;
        enum render_result result = renderer_view_draw(renderer, view, &params, &error);
        if (shot->frames == 0 && result == RENDER_UNCHANGED)
            break;
        if (result != RENDER_DRAWN)
            fail_msg("%s", error.message);
        assert_true(i + 1 < MAX_FRAMES);
        assert_true(renderer_view_collect(renderer, view, true, &frame));
        memcpy(pixels, frame.planes[0], (size_t)WIDTH * HEIGHT * 16);
        renderer_view_release(renderer, view);
    }
    assert_int_equal(renderer_gl_error_count(renderer), 0);
    renderer_view_destroy(renderer, &view);
    renderer_set_scene(renderer, NULL, NULL);
    scene_destroy(&scene);
    return pixels;
}

static int start_renderer(void **state)
{
    (void)state;
    struct error error = {""};
    renderer =
        renderer_create(&(struct renderer_params){.gpu = "software", .trace_budget = 4096}, &error);
    if (!renderer)
        print_error("%s\n", error.message);
    return renderer ? 0 : -1;
}

static int stop_renderer(void **state)
{
    (void)state;
    renderer_destroy(&renderer);
    return 0;
}

// Calls back for each entry's path.
static uint32_t for_all_entries(void (*call)(const char *path, uint32_t seed), uint32_t seed)
{
    char folder[128], path[512];
    snprintf(folder, sizeof(folder), "%s/voxcast/scenes", home);
    DIR *stream = opendir(folder);
    assert_non_null(stream);
    uint32_t count = 0;
    for (struct dirent *it; (it = readdir(stream));) {
        if (it->d_name[0] == '.')
            continue;
        snprintf(path, sizeof(path), "%s/%s", folder, it->d_name);
        call(path, seed + count++);
    }
    closedir(stream);
    return count;
}

// Flips a bit in the middle of an entry.
static void damage(const char *path, uint32_t seed)
{
    (void)seed;
    FILE *file = fopen(path, "r+b");
    assert_non_null(file);
    fseek(file, 0, SEEK_END);
    long middle = ftell(file) / 2;
    fseek(file, middle, SEEK_SET);
    int byte = fgetc(file);
    fseek(file, middle, SEEK_SET);
    fputc(byte ^ 1, file);
    fclose(file);
}

static void check_scene(const struct shot *shot)
{
    struct scene_cache_statistics before, after;
    scene_cache_open(0);
    float *without = draw(shot);
    scene_cache_open(512);
    for (int round = 0; round < 3; round++) {
        uint32_t damaged = round == 2 ? for_all_entries(damage, 0) : 0;
        before = scene_cache_get_statistics();
        float *with = draw(shot);
        after = scene_cache_get_statistics();
        print_message("%s: %llu found, %llu not, %llu of them damaged\n", shot->source,
                      (unsigned long long)(after.hits - before.hits),
                      (unsigned long long)(after.misses - before.misses),
                      (unsigned long long)(after.invalid - before.invalid));
        assert_memory_equal(with, without, (size_t)WIDTH * HEIGHT * 16);
        free(with);
        if (round == 1) {
            assert_int_equal(after.misses, before.misses);
            assert_true(after.hits > before.hits);
        }
        if (round == 2)
            assert_int_equal(after.invalid - before.invalid, damaged);
    }
    free(without);
}

static uint8_t *read_whole(const char *path, size_t *out_size)
{
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    fseek(file, 0, SEEK_END);
    *out_size = (size_t)ftell(file);
    rewind(file);
    uint8_t *bytes = malloc(*out_size);
    assert_non_null(bytes);
    assert_int_equal(fread(bytes, 1, *out_size, file), *out_size);
    fclose(file);
    return bytes;
}

// Replaces an entry by one with a right checksum and words changed: by the seed one bit of a word
// in many, all bits of one in sixteen, or all words. The key follows the magic number.
static void forge(const char *path, uint32_t seed)
{
    size_t size;
    uint8_t *bytes = read_whole(path, &size);
    struct cache_key key;
    memcpy(&key, bytes + 8, sizeof(key));
    uint32_t *words = (uint32_t *)(bytes + SCENE_CACHE_HEADER_BYTES),
             state = seed * 2654435761u + 1;
    for (size_t i = 0; i < (size - SCENE_CACHE_HEADER_BYTES) / 4; i++) {
        state = state * 1664525u + 1013904223u;
        if (seed % 3 == 0 && state >> 22 == 0)
            words[i] ^= 1u << (state & 31);
        else if (seed % 3 == 1 && state >> 28 == 0 && i >= 4)
            words[i] = state;
        else if (seed % 3 == 2)
            words[i] = 0xffffffffu;
    }
    scene_cache_write(&key, bytes + SCENE_CACHE_HEADER_BYTES, size - SCENE_CACHE_HEADER_BYTES);
    free(bytes);
}

static void test_forged_entries(void **state)
{
    (void)state;
    const struct shot shot = {"builtin:cornell-objects", 0};
    scene_cache_open(512);
    free(draw(&shot));
    for (uint32_t seed = 0; seed < 3; seed++) {
        assert_true(for_all_entries(forge, seed) > 0);
        free(draw(&shot));
    }
}

static void test_scene_made_by_code(void **state)
{
    (void)state;
    check_scene(&(struct shot){"builtin:atrium", 3});
}

static void test_converged_image(void **state)
{
    (void)state;
    check_scene(&(struct shot){"builtin:cornell-objects", 0});
}

static void test_scene_from_a_file(void **state)
{
    (void)state;
    const char *scenes = getenv("VOXCAST_SCENES");
    char path[4096];
    snprintf(path, sizeof(path), "%s/sponza/sponza.glb", scenes ? scenes : "");
    if (access(path, R_OK) != 0) {
        print_message("not tested: %s is not there\n", path);
        skip();
    }
    check_scene(&(struct shot){path, 3});
}

int main(void)
{
    // Repeatable frames; read when the driver starts.
    setenv("LP_NUM_THREADS", "1", 1);
    asset_cache_set_budget(0); // no image is remembered from one drawing to the next
#define TEST(name) cmocka_unit_test_setup_teardown(name, make_folder, remove_folder)
    const struct CMUnitTest tests[] = {
        TEST(test_scene_made_by_code),
        TEST(test_converged_image),
        TEST(test_scene_from_a_file),
        TEST(test_forged_entries),
    };
    return cmocka_run_group_tests(tests, start_renderer, stop_renderer);
}
