// Proves that a changed parameter leaves nothing of the former state in an image. Each row of the
// table is set after an image has converged; the new converged image is compared with a new view of
// a scene made in that state; then the parameter is set back and compared with the first image. So
// no dependency on a new setting can be forgotten.
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "renderer/import/builtin/builtin.h"
#include "renderer/import/builtin/mesh_builder.h"
#include "renderer/scene/scene.h"
#include "server/document/document.h"
#include "server/document/document_text.h"
#include "support_gi.h"

// Of 255, in any channel of any pixel. Two new views of one state are the same to the bit. Light in
// voxels that spreads from former light may end elsewhere within what counts as converged, 0.8 % of
// the brightest face. Measured: 2 for one parameter, else at most 1; errors of invalidation were 9
// to 158 when this was written.
#define BOUND 2.0

// The table's column `redraw`, in its order.
static const uint32_t redraws[] = {
#define PARAMETER(record, name, type, range, unit, initial, handling, redraw, ...)                 \
    INVALIDATES_##redraw,
#include "protocol/parameters/parameters.def"
#undef PARAMETER
};

struct stage {
    struct scene *scene;
    struct render_settings settings;
    struct view_options options;
    struct view *view;
};

// Materials and their nodes.
enum { FLOOR, MIRROR, SPECULAR_LOBE, PHONG, GLASS, VEIL, SIEVE, LIGHT };

static const char *const base[][2] = {
    {"view.width", "32"},
    {"view.height", "20"},
    {"view.quality", "interactive"},
    {"environment.type", "gradient"},
    {"environment.horizon_color", "0.2,0.4,0.8"},
    {"environment.intensity", "0.5"},
    {"camera.eye", "0.2,0.6,1.4"},
    {"camera.target", "0,0.2,0"},
    {"settings.clip_levels", "1"},
};

static void set_text(struct stage *stage, const char *key, const char *value)
{
    struct error error = {""};
    if (!document_set_text(stage->scene, &stage->settings, &stage->options, key, value, &error))
        fail_msg("%s", error.message);
}

static uint32_t add_material(struct scene *scene, const char *name, float grey, float roughness,
                             bool metal)
{
    struct scene_material material;
    scene_material_init(&material, name);
    for (int c = 0; c < 3; c++)
        material.base_color[c] = grey;
    material.roughness = roughness;
    material.metallic = metal ? 1.0f : 0.0f;
    return scene_add_material(scene, &material);
}

static void add_box(struct scene *scene, uint32_t material, const float low[3], const float high[3])
{
    struct mesh_builder builder;
    mesh_builder_init(&builder);
    mesh_builder_add_box(&builder, low, high, BOX_ALL);
    const char *name = scene->materials[material].name;
    uint32_t mesh = mesh_builder_commit_mesh(&builder, scene, name, material);
    mesh_builder_finish(&builder);
    assert_true(mesh != SCENE_NONE && builtin_add_mesh_node(scene, name, mesh) != SCENE_NONE);
}

// A corner with a mirror, a box of each kind, a light that is seen, and a spot. Crumbs far off make
// voxels coarse, so that there are few and light converges soon. What moves stays inside the
// bounds, since voxels that have once been laid out for a larger scene stay so.
static struct scene *make_scene(void)
{
    struct scene *scene = scene_create("everything");
    uint32_t floor = add_material(scene, "floor", 0.7f, 1.0f, false);
    uint32_t mirror = add_material(scene, "mirror", 0.9f, 0.05f, true);
    uint32_t specular = add_material(scene, "gloss", 0.4f, 0.3f, false);
    uint32_t phong = add_material(scene, "phong", 0.5f, 0.4f, false);
    uint32_t glass = add_material(scene, "glass", 0.9f, 0.0f, false);
    uint32_t veil = add_material(scene, "veil", 0.3f, 0.8f, false);
    uint32_t sieve = add_material(scene, "sieve", 0.6f, 1.0f, false);
    uint32_t emitter = add_material(scene, "lamp", 0.0f, 1.0f, false);
    scene->materials[phong].shading = SCENE_SHADING_BLINN_PHONG;
    scene->materials[glass].transmission = 1.0f;
    scene->materials[glass].thickness_m = 0.2f;
    scene->materials[glass].attenuation_distance_m = 0.5f;
    scene->materials[glass].attenuation_color[0] = 0.5f;
    scene->materials[veil].alpha_mode = SCENE_ALPHA_BLEND;
    scene->materials[veil].base_color[3] = 0.5f;
    scene->materials[sieve].alpha_mode = SCENE_ALPHA_MASK;
    scene->materials[sieve].base_color[3] = 0.55f;
    scene->materials[emitter].emissive_strength = 8.0f;
    for (int c = 0; c < 3; c++)
        scene->materials[emitter].emissive[c] = 1.0f;
    add_box(scene, floor, (float[3]){-0.6f, -0.1f, -0.5f}, (float[3]){0.6f, 0.0f, 0.5f});
    add_box(scene, mirror, (float[3]){-0.6f, 0.0f, -0.6f}, (float[3]){0.6f, 0.7f, -0.5f});
    add_box(scene, specular, (float[3]){-0.5f, 0.0f, -0.3f}, (float[3]){-0.25f, 0.3f, -0.1f});
    add_box(scene, phong, (float[3]){-0.15f, 0.0f, -0.3f}, (float[3]){0.1f, 0.35f, -0.1f});
    add_box(scene, glass, (float[3]){0.2f, 0.0f, -0.1f}, (float[3]){0.4f, 0.25f, 0.1f});
    add_box(scene, veil, (float[3]){-0.45f, 0.0f, 0.2f}, (float[3]){-0.2f, 0.15f, 0.25f});
    add_box(scene, sieve, (float[3]){0.3f, 0.0f, 0.3f}, (float[3]){0.5f, 0.1f, 0.35f});
    add_box(scene, emitter, (float[3]){0.1f, 0.75f, 0.0f}, (float[3]){0.3f, 0.8f, 0.2f});
    add_box(scene, floor, (float[3]){3.0f, 1.5f, 1.5f}, (float[3]){3.05f, 1.55f, 1.55f});
    add_box(scene, floor, (float[3]){-1.5f, -0.5f, -1.5f}, (float[3]){-1.45f, -0.45f, -1.45f});
    struct scene_light light;
    scene_light_init(&light, SCENE_LIGHT_SPOT, "spot");
    light.intensity = 2.0f;
    light.radius_m = 0.05f;
    light.range_m = 3.0f;
    light.inner_cone_rad = 0.2f;
    scene_add_light(scene, &light, (float[3]){-0.5f, 0.9f, 0.5f}, (float[3]){0.5f, -0.8f, -0.6f});
    return scene;
}

static void open_stage(struct stage *stage)
{
    *stage = (struct stage){.scene = make_scene()};
    render_settings_init(&stage->settings);
    view_options_init(&stage->options);
    for (size_t i = 0; i < sizeof(base) / sizeof(base[0]); i++)
        set_text(stage, base[i][0], base[i][1]);
    scene_update_world_transforms(stage->scene);
    stage->view = gi_show(stage->scene);
}

static void close_stage(struct stage *stage)
{
    gi_hide(&stage->view);
    scene_destroy(&stage->scene);
}

static struct test_picture draw(struct stage *stage)
{
    struct frame_params params = {
        .camera = stage->options.camera,
        .width = stage->options.width,
        .height = stage->options.height,
        .quality = stage->options.quality,
        .debug_view = stage->options.debug_view,
        .debug_level = stage->options.debug_level,
        .debug_face = stage->options.debug_face,
        .output = FRAME_OUTPUT_RGBA8,
        .settings = stage->settings,
    };
    return gi_draw_in(stage->view, &params);
}

// Values where the next best one would change nothing or is refused.
static const struct {
    enum parameter_group group;
    const char *name, *value;
} values[] = {
    {GROUP_ENVIRONMENT, "type", "constant"}, {GROUP_SETTINGS, "voxel_resolution", "128"},
    {GROUP_SETTINGS, "gamma", "2"},          {GROUP_MATERIAL, "alpha_cutoff", "0.6"},
    {GROUP_MATERIAL, "thickness_m", "0.05"}, {GROUP_SETTINGS, "gi_method", "none"},
};

// Settings and options of views that change no pixel of the first run, and why. All others must.
static const struct {
    const char *name, *why;
} excuses[] = {
    {"voxelize_every_frame", "makes the same voxels anew"},
    {"levels_per_frame", "spreads the same work over frames"},
    {"force_all_effects", "runs what has nothing to do"},
    {"debug_level", "of debug views of voxels"},
    {"debug_face", "likewise"},
};

static const struct {
    const char *name;
    uint32_t material;
} materials[] = {
    {"alpha_mode", VEIL},         {"base_color", VEIL},   {"alpha_cutoff", SIEVE},
    {"double_sided", SIEVE},      {"emissive", LIGHT},    {"emissive_strength", LIGHT},
    {"transmission", GLASS},      {"thickness_m", GLASS}, {"attenuation_distance_m", GLASS},
    {"attenuation_color", GLASS}, {"ior", GLASS},
};

static uint32_t id_of(const struct parameter *parameter)
{
    if (parameter->group == GROUP_NODE)
        return SPECULAR_LOBE;
    if (parameter->group != GROUP_MATERIAL)
        return 0;
    for (size_t i = 0; i < sizeof(materials) / sizeof(materials[0]); i++)
        if (strcmp(materials[i].name, parameter->name) == 0)
            return materials[i].material;
    return SPECULAR_LOBE;
}

static struct parameter_value other_value(const struct parameter_value *now)
{
    const struct parameter *parameter = now->parameter;
    struct parameter_value value = *now;
    struct rpc_error error;
    for (size_t i = 0; i < sizeof(values) / sizeof(values[0]); i++)
        if (values[i].group == parameter->group && strcmp(values[i].name, parameter->name) == 0) {
            assert_true(parameter_value_from_text(parameter, values[i].value, &value, &error));
            return value;
        }
    uint32_t count = parameter_component_count(parameter->type);
    for (uint32_t i = 0; i < count && count > 1; i++)
        value.numbers[i] += (now->numbers[i] > 0.5 ? -0.1 : 0.1) * (i + 1);
    if (parameter->type == PARAMETER_BOOL)
        value.numbers[0] = now->numbers[0] == 0.0;
    if (parameter->type == PARAMETER_ENUM)
        value.numbers[0] = fmod(now->numbers[0] + 1, parameter_value_count(parameter));
    if (parameter->type == PARAMETER_INT)
        value.numbers[0] += 1;
    if (parameter->type == PARAMETER_FLOAT)
        value.numbers[0] = now->numbers[0] == 0.0 ? 0.3 : 0.6 * now->numbers[0];
    value.numbers[0] = fmax(value.numbers[0], parameter->min);
    return value;
}

static struct document document_of(struct stage *stage)
{
    return (struct document){
        .scene = stage->scene, .settings = &stage->settings, .view = &stage->options};
}

static void set(struct stage *stage, const struct parameter_value *value)
{
    struct document document = document_of(stage);
    struct parameter_value copy = *value;
    struct rpc_error error;
    if (!document_set(&document, value->parameter->group, id_of(value->parameter), &copy, 1,
                      &error))
        fail_msg("%s", error.message);
}

static struct parameter_value get(struct stage *stage, const struct parameter *parameter)
{
    struct document document = document_of(stage);
    struct parameter_value value;
    document_get(&document, parameter, id_of(parameter), &value);
    return value;
}

// Largest difference of two images, of 255.
static double difference(const struct test_picture *a, const struct test_picture *b)
{
    double maximum = 0;
    if (a->width != b->width || a->height != b->height)
        return 255;
    for (size_t i = 0; i < (size_t)4 * a->width * a->height; i++)
        maximum = fmax(maximum, fabs((double)a->pixels[i] - b->pixels[i]));
    return maximum;
}

static bool is_among(const char *const *names, const char *name)
{
    while (*names && strcmp(*names, name) != 0)
        names++;
    return *names != NULL;
}

// For things in the scene, whose changes show in revisions, some parameters of each kind are
// enough; all with VOXCAST_TEST_FULL.
static bool is_chosen(const struct parameter *parameter)
{
    static const char *const chosen[] = {
        "intensity",  "radius_m", "position",    "roughness",    "emissive_strength",
        "alpha_mode", "visible",  "translation", "transmission", NULL};
    return parameter->group == GROUP_SETTINGS || parameter->group == GROUP_VIEW ||
           parameter->group == GROUP_CAMERA || gi_test_is_full() ||
           is_among(chosen, parameter->name);
}

#define MAX_CASES 128u

struct changed {
    struct parameter_value value;
    struct test_picture picture; // converged after the change
    double back;                 // difference to the first image once it was set back
};

struct run {
    const char *key, *value;  // set in addition to the base; NULL for nothing
    const char *const *names; // of the parameters to change; NULL for all that are chosen
    uint32_t count;
    struct changed changes[MAX_CASES];
    struct test_picture first;
};

static void open_run(struct stage *stage, const struct run *run)
{
    open_stage(stage);
    if (run->key)
        set_text(stage, run->key, run->value);
}

// Changes each parameter and takes it back, in one view.
static void draw_changes(struct run *run)
{
    struct stage stage;
    open_run(&stage, run);
    run->first = draw(&stage);
    for (size_t i = 0; i < parameter_count(); i++) {
        const struct parameter *parameter = parameter_at(i);
        if (redraws[i] == INVALIDATES_NOTHING || parameter->group == GROUP_ANIMATION ||
            !(run->names ? is_among(run->names, parameter->name) : is_chosen(parameter)))
            continue;
        assert_true(run->count < MAX_CASES);
        struct changed *changed = &run->changes[run->count++];
        struct parameter_value before = get(&stage, parameter);
        changed->value = other_value(&before);
        set(&stage, &changed->value);
        changed->picture = draw(&stage);
        set(&stage, &before);
        struct test_picture back = draw(&stage);
        changed->back = difference(&run->first, &back);
        gi_picture_finish(&back);
    }
    close_stage(&stage);
}

// Why a parameter has no effect; NULL if it must have one.
static const char *excuse_of(const struct parameter *parameter)
{
    if (parameter->group < GROUP_SETTINGS)
        return "things in the scene may be out of sight";
    for (size_t i = 0; i < sizeof(excuses) / sizeof(excuses[0]); i++)
        if (strcmp(excuses[i].name, parameter->name) == 0)
            return excuses[i].why;
    return NULL;
}

// How far the image is from that of a view without history: of a scene made anew, or at least with
// voxels of its own, where the scene is the same.
static void judge_change(struct run *run, const struct changed *changed, struct stage *shared,
                         struct gi_report *report, uint32_t *without_effect)
{
    const struct parameter *parameter = changed->value.parameter;
    struct stage stage = *shared;
    bool of_scene = parameter->group < GROUP_SETTINGS;
    if (of_scene)
        open_run(&stage, run);
    else
        assert_non_null(stage.view = renderer_view_create(test_renderer()));
    set(&stage, &changed->value);
    struct test_picture fresh = draw(&stage);
    double effect = difference(&fresh, &run->first);
    double left = difference(&fresh, &changed->picture);
    *without_effect += effect <= BOUND;
    const char *excuse = excuse_of(parameter);
    gi_check(report, effect > 0.0 || excuse, "%s.%s: it changes %g%s%s",
             parameter_group_names[parameter->group], parameter->name, effect, excuse ? ": " : "",
             excuse ? excuse : "");
    gi_check(report, left <= BOUND && changed->back <= BOUND,
             "%s.%s: %g of 255 from a fresh view, %g once set back (within %g; it changes %g)",
             parameter_group_names[parameter->group], parameter->name, left, changed->back, BOUND,
             effect);
    gi_picture_finish(&fresh);
    if (of_scene)
        close_stage(&stage);
    else
        renderer_view_destroy(test_renderer(), &stage.view);
}

static void judge_changes(struct run *run, struct gi_report *report)
{
    uint32_t without_effect = 0, i = 0;
    struct stage shared = {0};
    while (i < run->count && run->changes[i].value.parameter->group < GROUP_SETTINGS)
        judge_change(run, &run->changes[i++], &shared, report, &without_effect);
    open_run(&shared, run);
    while (i < run->count)
        judge_change(run, &run->changes[i++], &shared, report, &without_effect);
    close_stage(&shared);
    for (i = 0; i < run->count; i++)
        gi_picture_finish(&run->changes[i].picture);
    gi_picture_finish(&run->first);
    gi_check(report, 3 * without_effect <= run->count, "%u of %u change nothing here",
             without_effect, run->count);
}

static void check(const char *key, const char *value, const char *const *names)
{
    struct gi_report report = {0};
    struct run *run = calloc(1, sizeof(*run));
    assert_non_null(run);
    run->key = key;
    run->value = value;
    run->names = names;
    draw_changes(run);
    judge_changes(run, &report);
    free(run);
    gi_report_finish(&report);
}

static void test_every_parameter(void **state)
{
    (void)state;
    check(NULL, NULL, NULL);
}

// With rays and a single bounce, light converges at once, and no new generation shows that an edit
// came. Transparent layers show the cache all the same.
static void test_single_bounce(void **state)
{
    (void)state;
    static const char *const names[] = {"color", "intensity", "roughness", NULL};
    check("settings.bounces", "1", names);
}

// Where pixels gather the last bounce themselves, the cache must not hold it already.
static void test_limited_bounces(void **state)
{
    (void)state;
    static const char *const names[] = {"gather_mode", "quality", NULL};
    check("settings.bounces", "2", names);
}

// In a scene that has one Blinn-Phong material already, no effect bit shows that the others'
// shading model changes.
static void test_shading_in_reflections(void **state)
{
    (void)state;
    static const char *const names[] = {"shading_model", "shading", NULL};
    check("view.debug_view", "indirect_specular", names);
}

// One view goes through all of them, each compared with a new view of the same scene.
static void test_debug_views(void **state)
{
    (void)state;
    struct gi_report report = {0};
    struct stage stage;
    open_stage(&stage);
    struct view *old = stage.view;
    for (uint32_t i = 0; i < DEBUG_VIEW_COUNT; i++) {
        if (i == DEBUG_VIEW_CACHE_AGE)
            continue; // it shows what was asked for when
        stage.options.debug_view = (enum debug_view)i;
        stage.view = old;
        struct test_picture picture = draw(&stage);
        stage.view = renderer_view_create(test_renderer());
        assert_non_null(stage.view);
        struct test_picture fresh = draw(&stage);
        renderer_view_destroy(test_renderer(), &stage.view);
        double left = difference(&picture, &fresh);
        gi_check(&report, left <= BOUND, "%s: %g of 255 from a fresh view (within %g)",
                 debug_view_names[i], left, BOUND);
        gi_picture_finish(&picture);
        gi_picture_finish(&fresh);
    }
    stage.view = old;
    close_stage(&stage);
    gi_report_finish(&report);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_parameter), cmocka_unit_test(test_single_bounce),
        cmocka_unit_test(test_limited_bounces), cmocka_unit_test(test_shading_in_reflections),
        cmocka_unit_test(test_debug_views),
    };
    return cmocka_run_group_tests(tests, NULL, test_renderer_teardown);
}
