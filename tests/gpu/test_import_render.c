// Proves that imported scenes render: draws every sample of the khronos and features folders once,
// small, and checks that the image is finite, that GL reports no error, and that something besides
// the background is seen (except in files that hold only points or lines). Says so and skips where
// the folder of test scenes is absent.
#include <dirent.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include <cmocka.h>

#include "support_gpu.h"

static uint32_t drawn_count, refused_count;

static void frame_scene(const struct scene *scene, struct view_camera *camera)
{
    double low[3], high[3];
    if (!scene_bounds(scene, low, high))
        return;
    double radius = 0.0;
    for (int axis = 0; axis < 3; axis++)
        radius = fmax(radius, high[axis] - low[axis]);
    for (int axis = 0; axis < 3; axis++) {
        static const double direction[3] = {0.4, 0.35, 0.85};
        camera->target[axis] = (float)(0.5 * (low[axis] + high[axis]));
        camera->eye[axis] = camera->target[axis] + (float)(3.0 * radius * direction[axis]);
    }
}

static void draw_file(const char *path)
{
    struct error error = {""};
    struct scene *scene = scene_load(path, &error);
    if (!scene) {
        // Unsupported features are refused by their names.
        if (!strstr(error.message, "not supported"))
            fail_msg("%s: %s", path, error.message);
        refused_count++;
        return;
    }
    struct frame_params params = test_params(64, 48, FRAME_OUTPUT_LINEAR);
    params.quality = QUALITY_INTERACTIVE;
    params.camera.target[2] = -1.0f;
    frame_scene(scene, &params.camera);
    uint64_t errors_before = renderer_gl_error_count(test_renderer());
    struct test_picture picture = test_draw_linear(scene, &params);
    for (size_t i = 0; i < (size_t)picture.width * picture.height * 4; i++)
        if (!isfinite(picture.pixels[i]) || picture.pixels[i] < 0.0f)
            fail_msg("%s: value %zu is %g", path, i, (double)picture.pixels[i]);
    if (renderer_gl_error_count(test_renderer()) != errors_before)
        fail_msg("%s: GL reported an error", path);
    bool seen = scene_triangle_count(scene) == 0;
    params.debug_view = DEBUG_VIEW_IDS;
    struct test_picture ids = test_draw_linear(scene, &params);
    for (size_t i = 0; i < (size_t)ids.width * ids.height * 4 && !seen; i += 4)
        seen = ids.pixels[i] > 0.0f;
    if (!seen)
        fail_msg("%s: nothing is seen", path);
    drawn_count++;
    free(picture.pixels);
    free(ids.pixels);
    renderer_set_scene(test_renderer(), NULL, &error);
    scene_destroy(&scene);
}

static void draw_folder(const char *folder)
{
    DIR *directory = opendir(folder);
    if (!directory)
        return;
    for (struct dirent *entry; (entry = readdir(directory));) {
        char path[1024];
        struct stat status;
        snprintf(path, sizeof(path), "%s/%s", folder, entry->d_name);
        if (entry->d_name[0] == '.' || stat(path, &status) != 0)
            continue;
        size_t length = strlen(path);
        if (S_ISDIR(status.st_mode))
            draw_folder(path);
        else if (strcmp(path + length - 4, ".glb") == 0 || strcmp(path + length - 5, ".gltf") == 0)
            draw_file(path);
    }
    closedir(directory);
}

static void test_samples_render(void **state)
{
    (void)state;
    const char *scenes = getenv("VOXCAST_SCENES");
    char path[1024];
    static const char *const folders[] = {"khronos", "features", "cornell"};
    struct stat status;
    snprintf(path, sizeof(path), "%s/khronos", scenes ? scenes : "");
    if (!scenes || stat(path, &status) != 0) {
        print_message("skipped: VOXCAST_SCENES (%s) holds no folder of sample scenes\n",
                      scenes ? scenes : "unset");
        skip();
    }
    for (size_t i = 0; i < sizeof(folders) / sizeof(folders[0]); i++) {
        snprintf(path, sizeof(path), "%s/%s", scenes, folders[i]);
        draw_folder(path);
    }
    print_message("%u samples drawn, %u refused by name\n", drawn_count, refused_count);
    assert_true(drawn_count >= 30);
}

int main(void)
{
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_samples_render)};
    return cmocka_run_group_tests(tests, NULL, test_renderer_teardown);
}
