// Proves that images stay as they were approved: renders every built-in scene and every debug view
// small, with fixed exposure, and compares them with the kept images. At most 0.1 % of pixels may
// differ by more than 5/255 in any channel. On failure the actual image and an amplified difference
// are written to the working folder.
//
//     test_golden [--update] [--driver TEXT] [NAME]...
//
// --update writes the kept images. With names, only these images. --driver fails unless the GL
// renderer's name contains the text.
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb_image_write.h>
#pragma GCC diagnostic pop

#include "renderer/renderer.h"
#include "renderer/image/image_decode.h"
#include "voxcast_paths.h"

#define WIDTH                192u
#define HEIGHT               108u
#define MAX_DIFFERENCE       5
#define MAX_OUTLIER_FRACTION 0.001

struct golden {
    char name[64];
    char scene[64];
    char camera[64]; // "" for the first
    enum debug_view view;
    enum quality quality;
    enum gi_method gi_method;
};

// $VOXCAST_GOLDEN_DIR where the test runs elsewhere.
static const char *golden_folder = VOXCAST_SOURCE_DIR "/tests/golden/pictures";

// Renders into RGB bytes; NULL with a message on failure.
static uint8_t *render(struct renderer *renderer, const struct golden *golden)
{
    struct error error = {""};
    struct frame_params params = {.width = WIDTH,
                                  .height = HEIGHT,
                                  .quality = golden->quality,
                                  .debug_view = golden->view,
                                  .output = FRAME_OUTPUT_RGBA8};
    render_settings_init(&params.settings);
    params.settings.gi_method = golden->gi_method;
    uint8_t *rgb = NULL;
    struct view *view = renderer_view_create(renderer);
    struct scene *scene = scene_load(golden->scene, &error);
    if (!scene || !renderer_set_scene(renderer, scene, &error))
        goto done;
    uint32_t camera = 0;
    for (uint32_t i = 0; i < scene->camera_count; i++)
        if (strcmp(scene->cameras[i].name, golden->camera) == 0)
            camera = i;
    scene_get_camera_placement(scene, camera, params.camera.eye, params.camera.target,
                               params.camera.up);
    params.camera.fov_y_rad = scene->cameras[camera].fov_y_rad;
    struct frame_pixels pixels;
    enum render_result result;
    rgb = malloc((size_t)WIDTH * HEIGHT * 3);
    while (rgb && (result = renderer_view_draw(renderer, view, &params, &error)) == RENDER_DRAWN &&
           renderer_view_collect(renderer, view, true, &pixels)) {
        for (uint32_t i = 0; i < WIDTH * HEIGHT; i++)
            memcpy(rgb + 3 * (size_t)i, pixels.planes[0] + 4 * (size_t)i, 3);
        renderer_view_release(renderer, view);
    }
    if (rgb && result != RENDER_UNCHANGED) {
        free(rgb);
        rgb = NULL;
    }
done:
    if (!rgb)
        fprintf(stderr, "%s: %s\n", golden->name, error.message);
    renderer_view_destroy(renderer, &view);
    renderer_set_scene(renderer, NULL, &error);
    scene_destroy(&scene);
    return rgb;
}

static struct image *read_picture(const char *path)
{
    FILE *file = fopen(path, "rb");
    if (!file)
        return NULL;
    static uint8_t bytes[1 << 20];
    size_t size = fread(bytes, 1, sizeof(bytes), file);
    fclose(file);
    struct error error;
    return image_decode(bytes, size, &error);
}

static bool update(const struct golden *golden, const uint8_t *rgb)
{
    char path[512];
    snprintf(path, sizeof(path), "%s/%.60s.png", golden_folder, golden->name);
    printf("writing %s\n", path);
    return stbi_write_png(path, WIDTH, HEIGHT, 3, rgb, 0) != 0;
}

static bool compare(const struct golden *golden, const uint8_t *rgb)
{
    char path[512];
    snprintf(path, sizeof(path), "%s/%.60s.png", golden_folder, golden->name);
    struct image *kept = read_picture(path);
    if (!kept || kept->width != WIDTH || kept->height != HEIGHT) {
        fprintf(stderr, "%s: %s is missing or of another size\n", golden->name, path);
        image_release(&kept);
        return false;
    }
    uint8_t *difference = calloc((size_t)WIDTH * HEIGHT, 3);
    uint32_t outliers = 0;
    int worst = 0;
    for (uint32_t i = 0; i < WIDTH * HEIGHT && difference; i++) {
        int largest = 0;
        for (uint32_t c = 0; c < 3; c++) {
            int d = abs(rgb[3 * i + c] - kept->rgba[4 * i + c]);
            difference[3 * i + c] = (uint8_t)(d * 16 > 255 ? 255 : d * 16);
            largest = d > largest ? d : largest;
        }
        outliers += largest > MAX_DIFFERENCE;
        worst = largest > worst ? largest : worst;
    }
    bool same = difference && outliers <= MAX_OUTLIER_FRACTION * WIDTH * HEIGHT;
    printf("%-34s %s  worst %3d/255, %u of %u pixels beyond %d/255\n", golden->name,
           same ? "ok    " : "FAILED", worst, outliers, WIDTH * HEIGHT, MAX_DIFFERENCE);
    if (!same) {
        snprintf(path, sizeof(path), "%.60s.actual.png", golden->name);
        stbi_write_png(path, WIDTH, HEIGHT, 3, rgb, 0);
        snprintf(path, sizeof(path), "%.60s.difference.png", golden->name);
        stbi_write_png(path, WIDTH, HEIGHT, 3, difference, 0);
    }
    free(difference);
    image_release(&kept);
    return same;
}

static uint32_t list_goldens(struct golden *goldens, uint32_t capacity)
{
    uint32_t count = 0;
    for (uint32_t i = 0; scene_builtin_name(i) && count < capacity; i++) {
        struct golden *golden = &goldens[count++];
        *golden = (struct golden){.quality = QUALITY_FINAL};
        snprintf(golden->name, sizeof(golden->name), "%s", scene_builtin_name(i));
        snprintf(golden->scene, sizeof(golden->scene), "builtin:%s", scene_builtin_name(i));
    }
    for (int view = DEBUG_VIEW_FINAL + 1; view < DEBUG_VIEW_VOXEL_OPACITY && count < capacity;
         view++) {
        // Materials are best seen among the objects; tiles and cascades need their kinds of lights.
        const char *scene = "cornell-objects";
        if (view == DEBUG_VIEW_LIGHTS_PER_TILE)
            scene = "atrium-lights";
        if (view == DEBUG_VIEW_SHADOW_CASCADES || view == DEBUG_VIEW_ALBEDO)
            scene = "atrium";
        struct golden *golden = &goldens[count++];
        *golden = (struct golden){.view = (enum debug_view)view, .quality = QUALITY_FINAL};
        snprintf(golden->name, sizeof(golden->name), "view-%s", debug_view_names[view]);
        snprintf(golden->scene, sizeof(golden->scene), "builtin:%s", scene);
    }
    static const struct golden lit[] = {
        {"gi-cornell", "builtin:cornell", .gi_method = GI_METHOD_GRID},
        {"gi-cornell-objects", "builtin:cornell-objects", .gi_method = GI_METHOD_CLIPMAP},
        {"gi-atrium", "builtin:atrium", .gi_method = GI_METHOD_CLIPMAP},
        {"gi-material-grid", "builtin:material-grid", .gi_method = GI_METHOD_GRID},
        {"gi-high-cornell", "builtin:cornell", .gi_method = GI_METHOD_CLIPMAP,
         .quality = QUALITY_HIGH},
        {"gi-final-cornell", "builtin:cornell", .gi_method = GI_METHOD_GRID,
         .quality = QUALITY_FINAL},
    };
    for (size_t i = 0; i < sizeof(lit) / sizeof(lit[0]) && count < capacity; i++) {
        goldens[count] = lit[i];
        if (goldens[count].quality == QUALITY_DRAFT)
            goldens[count].quality = QUALITY_INTERACTIVE;
        count++;
    }
    // What voxels, cache and tiles hold, once light has converged. The age of requests has no end.
    for (int view = DEBUG_VIEW_VOXEL_OPACITY; view < DEBUG_VIEW_COUNT && count < capacity; view++) {
        if (view == DEBUG_VIEW_CACHE_AGE)
            continue;
        struct golden *golden = &goldens[count++];
        *golden = (struct golden){.view = (enum debug_view)view,
                                  .quality = QUALITY_INTERACTIVE,
                                  .gi_method = GI_METHOD_CLIPMAP};
        snprintf(golden->name, sizeof(golden->name), "view-%s", debug_view_names[view]);
        snprintf(golden->scene, sizeof(golden->scene), "builtin:cornell-objects");
    }
    if (count < capacity)
        goldens[count++] = (struct golden){
            .name = "cornell-draft", .scene = "builtin:cornell", .quality = QUALITY_DRAFT};
    return count;
}

static bool is_named(const struct golden *golden, char **names)
{
    for (; *names; names++)
        if (strcmp(*names, golden->name) == 0)
            return true;
    return false;
}

int main(int argc, char **argv)
{
    bool updating = false;
    const char *driver = "";
    for (; argc > 1 && strncmp(argv[1], "--", 2) == 0; argc--, argv++) {
        if (strcmp(argv[1], "--update") == 0) {
            updating = true;
        } else if (strcmp(argv[1], "--driver") == 0 && argc > 2) {
            driver = argv[2];
            argc--, argv++;
        } else {
            fprintf(stderr, "unknown option %s\n", argv[1]);
            return 2;
        }
    }
    if (getenv("VOXCAST_GOLDEN_DIR"))
        golden_folder = getenv("VOXCAST_GOLDEN_DIR");
    log_set_level(LOG_ERROR);
    struct error error;
    struct renderer *renderer = renderer_create(&(struct renderer_params){.gpu = "auto"}, &error);
    if (!renderer) {
        fprintf(stderr, "no renderer: %s\n", error.message);
        return 1;
    }
    const char *name = renderer_get_info(renderer)->gl_renderer;
    uint32_t failed = strstr(name, driver) == NULL;
    if (failed > 0)
        fprintf(stderr, "the driver is %s, not %s\n", name, driver);
    struct golden goldens[64];
    for (uint32_t i = 0, count = list_goldens(goldens, 64); i < count; i++) {
        if (argc > 1 && !is_named(&goldens[i], argv + 1))
            continue;
        uint8_t *rgb = render(renderer, &goldens[i]);
        bool done = rgb && (updating ? update(&goldens[i], rgb) : compare(&goldens[i], rgb));
        failed += !done;
        free(rgb);
    }
    bool gl_errors = renderer_gl_error_count(renderer) > 0;
    renderer_destroy(&renderer);
    if (gl_errors)
        fprintf(stderr, "GL reported errors\n");
    return failed || gl_errors;
}
