// Shows that a change does not alter any image. `bit_equal keep FOLDER [SCENE...]` draws scenes
// with all presets, methods, debug views and settings and keeps the images as floats. `bit_equal
// compare FOLDER [SCENE...]` of another build draws them again and fails unless every bit is the
// same. Without scenes: the built-in ones, and the files below $VOXCAST_SCENES.
//
// Images are 48x27: few pixels run all of the code, too.
#include <dirent.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "renderer/path_tracer/reference.h"
#include "renderer/metrics/picture.h"
#include "renderer/renderer.h"

#define WIDTH       48u
#define HEIGHT      27u
#define FLOATS      ((size_t)WIDTH * HEIGHT * 3)
#define MAX_SOURCES 256u
#define SOURCE_SIZE 512u
// Of a path-traced image.
#define SAMPLES 2u
// Budget of the irradiance cache in a frame: measured times must not decide it.
#define TRACE_BUDGET 20000u

static const char usage[] = "usage: bit_equal keep|compare FOLDER [SCENE...]\n";

struct session {
    const char *folder;
    bool comparing;
    struct renderer *renderer;
    struct scene *scene;
    const char *label; // of the scene, in names of files
    uint32_t picture_count;
    uint32_t failed_count;
};

// What is drawn once.
struct shot {
    char name[96];
    enum quality quality;
    enum gi_method gi_method;
    enum debug_view debug_view;
    uint32_t frame_count; // the last one is kept
    bool moves;           // the camera, before the last frame
    void (*adjust)(struct render_settings *settings);
};

static void check_picture(struct session *session, const char *name, const struct picture *picture)
{
    char path[1024];
    struct picture kept;
    struct error error = {""};
    snprintf(path, sizeof(path), "%s/%s-%s.pfm", session->folder, session->label, name);
    session->picture_count++;
    if (!session->comparing) {
        if (!picture_write_pfm(path, picture, &error)) {
            fprintf(stderr, "%s\n", error.message);
            session->failed_count++;
        }
        return;
    }
    if (!picture_read_pfm(path, &kept, &error)) {
        fprintf(stderr, "%s\n", error.message);
        session->failed_count++;
        return;
    }
    uint32_t different_count = 0;
    double largest = 0.0;
    for (size_t i = 0; i < FLOATS; i++) {
        if (memcmp(&kept.rgb[i], &picture->rgb[i], sizeof(float)) == 0)
            continue;
        different_count++;
        largest = fmax(largest, fabs((double)kept.rgb[i] - picture->rgb[i]));
    }
    if (different_count > 0) {
        printf("%s-%s: %u of %zu values differ, by up to %g\n", session->label, name,
               different_count, FLOATS, largest);
        fflush(stdout);
        session->failed_count++;
    }
    picture_finish(&kept);
}

static void take_pixels(const struct frame_pixels *pixels, struct picture *picture)
{
    for (size_t y = 0; y < HEIGHT; y++) {
        const float *row =
            (const float *)(const void *)(pixels->planes[0] + y * pixels->row_pitch_bytes[0]);
        for (size_t x = 0; x < WIDTH; x++)
            memcpy(&picture->rgb[(y * WIDTH + x) * 3], &row[x * 4], 3 * sizeof(float));
    }
}

static void set_camera(const struct scene *scene, struct view_camera *out_camera)
{
    static const struct view_camera fallback = {
        .eye = {2.0f, 1.5f, 3.0f}, .up = {0.0f, 1.0f, 0.0f}, .fov_y_rad = 0.9f};
    *out_camera = fallback;
    if (scene->camera_count == 0)
        return;
    scene_get_camera_placement(scene, 0, out_camera->eye, out_camera->target, out_camera->up);
    out_camera->fov_y_rad = scene->cameras[0].fov_y_rad;
}

// Draws into `picture`, which stays black if nothing can be drawn.
static bool draw_frames(struct session *session, const struct shot *shot, struct view *view,
                        struct picture *picture, struct error *out_error)
{
    struct frame_params params = {.width = WIDTH,
                                  .height = HEIGHT,
                                  .quality = shot->quality,
                                  .debug_view = shot->debug_view,
                                  .output = FRAME_OUTPUT_LINEAR};
    render_settings_init(&params.settings);
    params.settings.gi_method = shot->gi_method;
    if (shot->adjust)
        shot->adjust(&params.settings);
    set_camera(session->scene, &params.camera);
    for (uint32_t frame = 0; frame < shot->frame_count; frame++) {
        struct frame_pixels pixels;
        if (shot->moves && frame + 1 == shot->frame_count)
            params.camera.eye[0] += 0.05f;
        enum render_result result = renderer_view_draw(session->renderer, view, &params, out_error);
        if (result == RENDER_UNCHANGED)
            return true;
        if (result != RENDER_DRAWN ||
            !renderer_view_collect(session->renderer, view, true, &pixels))
            return false;
        take_pixels(&pixels, picture);
        renderer_view_release(session->renderer, view);
    }
    return true;
}

static void draw_shot(struct session *session, const struct shot *shot)
{
    struct error error = {""};
    struct picture picture;
    struct view *view = renderer_view_create(session->renderer);
    if (!view || !picture_init(&picture, WIDTH, HEIGHT)) {
        fprintf(stderr, "out of memory\n");
        exit(1);
    }
    if (!draw_frames(session, shot, view, &picture, &error)) {
        fprintf(stderr, "%s-%s: %s\n", session->label, shot->name, error.message);
        session->failed_count++;
    } else {
        check_picture(session, shot->name, &picture);
    }
    picture_finish(&picture);
    renderer_view_destroy(session->renderer, &view);
}

static void draw_presets(struct session *session)
{
    static const enum gi_method methods[] = {GI_METHOD_NONE, GI_METHOD_CLIPMAP, GI_METHOD_GRID};
    for (uint32_t quality = 0; quality < QUALITY_COUNT; quality++)
        for (uint32_t i = 0; i < sizeof(methods) / sizeof(methods[0]); i++) {
            struct shot shot = {
                .quality = (enum quality)quality, .gi_method = methods[i], .frame_count = 3};
            snprintf(shot.name, sizeof(shot.name), "%s-%s", quality_names[quality],
                     gi_method_names[methods[i]]);
            draw_shot(session, &shot);
        }
}

static void draw_debug_views(struct session *session)
{
    for (uint32_t view = DEBUG_VIEW_FINAL + 1; view < DEBUG_VIEW_COUNT; view++) {
        struct shot shot = {.quality = QUALITY_INTERACTIVE,
                            .gi_method = GI_METHOD_CLIPMAP,
                            .debug_view = (enum debug_view)view,
                            .frame_count = 2};
        snprintf(shot.name, sizeof(shot.name), "view-%s", debug_view_names[view]);
        draw_shot(session, &shot);
        if (!debug_view_needs_voxels(shot.debug_view))
            continue;
        shot.gi_method = GI_METHOD_GRID;
        shot.quality = QUALITY_FINAL;
        snprintf(shot.name, sizeof(shot.name), "view-%s-grid", debug_view_names[view]);
        draw_shot(session, &shot);
    }
}

static void set_cache(struct render_settings *s)
{
    s->gather_mode = GATHER_CACHE;
}
static void set_half(struct render_settings *s)
{
    s->gather_mode = GATHER_HALF;
}
static void set_pixel(struct render_settings *s)
{
    s->gather_mode = GATHER_PIXEL;
}
static void set_rays(struct render_settings *s)
{
    s->gather_mode = GATHER_RAYS;
}
static void set_isotropic(struct render_settings *s)
{
    s->voxel_directions = VOXEL_ISOTROPIC;
}
static void set_two_levels(struct render_settings *s)
{
    s->clip_levels = 2;
}
static void set_one_level(struct render_settings *s)
{
    s->levels_per_frame = LEVELS_PER_FRAME_ONE;
}
static void set_one_bounce(struct render_settings *s)
{
    s->bounces = 1;
}
static void set_no_occlusion(struct render_settings *s)
{
    s->ambient_occlusion = false;
}
static void set_hard_shadows(struct render_settings *s)
{
    s->soft_shadows = false;
}
static void set_no_shadows(struct render_settings *s)
{
    s->shadows = false;
}
static void set_no_specular(struct render_settings *s)
{
    s->indirect_specular = false;
}
static void set_no_refraction(struct render_settings *s)
{
    s->refraction = false;
}
static void set_no_environment(struct render_settings *s)
{
    s->environment_light = false;
}
static void set_blinn_phong(struct render_settings *s)
{
    s->shading_model = SHADING_MODEL_BLINN_PHONG;
}
static void set_every_effect(struct render_settings *s)
{
    s->force_all_effects = true;
}
static void set_nine_cones(struct render_settings *s)
{
    s->cone_set = CONE_SET_9;
}

static void draw_settings(struct session *session)
{
    static const struct {
        const char *name;
        void (*adjust)(struct render_settings *settings);
    } adjustments[] = {{"cache", set_cache},
                       {"half", set_half},
                       {"pixel", set_pixel},
                       {"rays", set_rays},
                       {"isotropic", set_isotropic},
                       {"two-levels", set_two_levels},
                       {"one-level", set_one_level},
                       {"one-bounce", set_one_bounce},
                       {"no-occlusion", set_no_occlusion},
                       {"hard-shadows", set_hard_shadows},
                       {"no-shadows", set_no_shadows},
                       {"no-specular", set_no_specular},
                       {"no-refraction", set_no_refraction},
                       {"no-environment", set_no_environment},
                       {"blinn-phong", set_blinn_phong},
                       {"every-effect", set_every_effect},
                       {"nine-cones", set_nine_cones}};
    for (size_t i = 0; i < sizeof(adjustments) / sizeof(adjustments[0]); i++) {
        struct shot shot = {.quality = QUALITY_HIGH,
                            .gi_method = GI_METHOD_CLIPMAP,
                            .frame_count = 3,
                            .adjust = adjustments[i].adjust};
        snprintf(shot.name, sizeof(shot.name), "set-%s", adjustments[i].name);
        draw_shot(session, &shot);
    }
    draw_shot(session,
              &(struct shot){"rest", QUALITY_INTERACTIVE, GI_METHOD_CLIPMAP, .frame_count = 60});
    draw_shot(session,
              &(struct shot){"rest-high", QUALITY_HIGH, GI_METHOD_GRID, .frame_count = 40});
}

static void trace_paths(struct session *session)
{
    struct error error = {""};
    struct reference_params params = {
        .width = WIDTH, .height = HEIGHT, .max_bounces = REFERENCE_UNLIMITED, .seed = 5};
    struct picture picture = {0};
    static float rgba[WIDTH * HEIGHT * 4];
    set_camera(session->scene, &params.camera);
    params.scene = snapshot_create(session->scene, false, &error);
    struct reference *reference = params.scene ? reference_create(&params, &error) : NULL;
    if (reference && picture_init(&picture, WIDTH, HEIGHT) &&
        reference_render(reference, SAMPLES)) {
        reference_get_picture(reference, REFERENCE_ALL_LAYERS, rgba);
        for (size_t i = 0; i < FLOATS; i++)
            picture.rgb[i] = rgba[i / 3 * 4 + i % 3];
        check_picture(session, "paths", &picture);
    } else {
        fprintf(stderr, "%s-paths: %s\n", session->label, error.message);
        session->failed_count++;
    }
    picture_finish(&picture);
    reference_destroy(&reference);
    snapshot_release(&params.scene);
}

// Scene files get fewer images: they differ from the built-in scenes only in what is read.
static void draw_few(struct session *session)
{
    const struct shot shots[] = {
        {"draft-none", QUALITY_DRAFT, GI_METHOD_NONE, .frame_count = 1},
        {"interactive-clipmap", QUALITY_INTERACTIVE, GI_METHOD_CLIPMAP, .frame_count = 2},
        {"moving", QUALITY_INTERACTIVE, GI_METHOD_CLIPMAP, .frame_count = 2, .moves = true},
        {"high-grid", QUALITY_HIGH, GI_METHOD_GRID, .frame_count = 2}};
    for (size_t i = 0; i < sizeof(shots) / sizeof(shots[0]); i++)
        draw_shot(session, &shots[i]);
}

// builtin:atrium -> builtin_atrium, a/b.glb -> b.glb
static void make_label(const char *source, char *out_label)
{
    const char *slash = strrchr(source, '/');
    snprintf(out_label, SOURCE_SIZE, "%s", slash ? slash + 1 : source);
    for (char *c = out_label; *c; c++)
        if (*c == ':' || *c == ' ')
            *c = '_';
}

static void draw_source(struct session *session, const char *source)
{
    struct error error = {""};
    char label[SOURCE_SIZE];
    bool builtin = strncmp(source, "builtin:", 8) == 0;
    make_label(source, label);
    session->label = label;
    session->scene = scene_load(source, &error);
    // Both builds refuse what cannot be read; other tests cover that.
    if (!session->scene)
        return;
    uint32_t failed_before = session->failed_count;
    if (!renderer_set_scene(session->renderer, session->scene, &error)) {
        fprintf(stderr, "%s: %s\n", source, error.message);
        session->failed_count++;
    } else if (builtin) {
        draw_presets(session);
        if (strncmp(source, "builtin:cornell", 15) == 0)
            draw_debug_views(session);
        draw_shot(session, &(struct shot){"moving", QUALITY_INTERACTIVE, GI_METHOD_CLIPMAP,
                                          .frame_count = 5, .moves = true});
        if (strcmp(source, "builtin:cornell-objects") == 0)
            draw_settings(session);
        trace_paths(session);
    } else {
        draw_few(session);
        trace_paths(session);
    }
    printf("%-40s %s\n", label, session->failed_count == failed_before ? "ok" : "DIFFERENT");
    fflush(stdout);
    renderer_set_scene(session->renderer, NULL, &error);
    scene_destroy(&session->scene);
}

static bool has_extension(const char *name, const char *extension)
{
    const char *dot = strrchr(name, '.');
    return dot && strcmp(dot, extension) == 0;
}

// Adds the scene files of a folder and of those within.
static void list_files(const char *folder, char (*sources)[SOURCE_SIZE], uint32_t *count)
{
    struct dirent **entries;
    int entry_count = scandir(folder, &entries, NULL, alphasort);
    for (int i = 0; i < entry_count; i++) {
        const char *name = entries[i]->d_name;
        char path[SOURCE_SIZE];
        struct stat status;
        int length = snprintf(path, sizeof(path), "%s/%s", folder, name);
        // Hostile files are covered by the importers' tests.
        if (name[0] != '.' && strcmp(name, "hostile") != 0 && length < (int)sizeof(path) &&
            stat(path, &status) == 0) {
            if (S_ISDIR(status.st_mode))
                list_files(path, sources, count);
            else if ((has_extension(name, ".glb") || has_extension(name, ".gltf") ||
                      has_extension(name, ".obj")) &&
                     *count < MAX_SOURCES)
                memcpy(sources[(*count)++], path, sizeof(path));
        }
        free(entries[i]);
    }
    if (entry_count >= 0)
        free(entries);
}

static uint32_t list_sources(char (*sources)[SOURCE_SIZE])
{
    uint32_t count = 0;
    for (uint32_t i = 0; scene_builtin_name(i); i++)
        snprintf(sources[count++], SOURCE_SIZE, "builtin:%s", scene_builtin_name(i));
    const char *folder = getenv("VOXCAST_SCENES");
    list_files(folder ? folder : "../shared/scenes", sources, &count);
    return count;
}

int main(int argc, char **argv)
{
    static char sources[MAX_SOURCES][SOURCE_SIZE];
    bool comparing = argc > 1 && strcmp(argv[1], "compare") == 0;
    if (argc < 3 || (!comparing && strcmp(argv[1], "keep") != 0)) {
        fputs(usage, stderr);
        return 2;
    }
    log_set_level(LOG_ERROR);
    // The order of threads decides which faces the irradiance cache traces first.
    setenv("LP_NUM_THREADS", "1", 1);
    struct error error = {""};
    struct session session = {.folder = argv[2], .comparing = comparing};
    mkdir(session.folder, 0755);
    session.renderer = renderer_create(
        &(struct renderer_params){.gpu = "software", .trace_budget = TRACE_BUDGET}, &error);
    if (!session.renderer) {
        fprintf(stderr, "no renderer: %s\n", error.message);
        return 1;
    }
    if (argc > 3) {
        for (int i = 3; i < argc; i++)
            draw_source(&session, argv[i]);
    } else {
        uint32_t count = list_sources(sources);
        for (uint32_t i = 0; i < count; i++)
            draw_source(&session, sources[i]);
    }
    bool gl_errors = renderer_gl_error_count(session.renderer) > 0;
    renderer_destroy(&session.renderer);
    printf("%u pictures, %u %s%s\n", session.picture_count, session.failed_count,
           comparing ? "different" : "failed", gl_errors ? ", and GL reported errors" : "");
    return session.failed_count > 0 || gl_errors || session.picture_count == 0;
}
