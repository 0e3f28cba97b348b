// Proves that every shader compiles as frames can ask for it, that passes declare what it binds,
// that what it reads is there, and that no name of its conditions is forgotten.
//
// Plans of many random frames tell which permutations are reachable. Of a program that has few, all
// are compiled; of the others enough to have each value of each define together with each value of
// each other one, as far as they occur together: what fails to compile is nearly always one #if
// within another.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "renderer/gi/gi_method.h"
#include "renderer/gpu/program.h"
#include "renderer/gpu/shader_source.h"
#include "renderer/hash.h"
#include "renderer/passes/pass.h"
#include "voxcast_paths.h"

#define FRAMES    40000
#define FEW       24 // permutations
#define MAX_LINES 32
#define SET_SIZE  (1u << 18) // slots, of hashes

static uint64_t seed = 1;

static uint32_t below(uint32_t end)
{
    seed = seed * 6364136223846793005ull + 1442695040888963407ull;
    return (uint32_t)((seed >> 33) % end);
}

// A set of hashes.
struct set {
    uint32_t count;
    uint64_t slots[SET_SIZE];
};

static bool add(struct set *set, uint64_t hash)
{
    uint32_t at = (uint32_t)(hash ^ hash >> 32) % SET_SIZE;
    while (set->slots[at] != 0 && set->slots[at] != hash)
        at = (at + 1) % SET_SIZE;
    if (set->slots[at] == hash)
        return false;
    set->slots[at] = hash;
    assert_true(++set->count < SET_SIZE / 2);
    return true;
}

static uint64_t hash_text(uint64_t hash, const char *text, size_t length)
{
    return hash_bytes(hash, text, length);
}

// Adds each pair of lines. Returns the number of new ones.
static uint32_t add_pairs(struct set *pairs, uint64_t program, const char *defines)
{
    uint64_t lines[MAX_LINES];
    uint32_t count = 0, added = 0;
    while (*defines) {
        size_t length = strcspn(defines, "\n");
        assert_true(count < MAX_LINES);
        lines[count++] = hash_text(HASH_START, defines, length);
        defines += length + (defines[length] == '\n');
    }
    for (uint32_t i = 0; i < count; i++)
        for (uint32_t j = i; j < count; j++)
            added +=
                add(pairs,
                    hash_word(hash_word(hash_word(HASH_START, program), lines[i]), lines[j]) | 1);
    return added;
}

static void random_scene(struct scene_facts *scene)
{
    uint32_t *counts = (uint32_t *)&scene->counts;
    for (size_t i = 0; i < sizeof(scene->counts) / sizeof(*counts); i++)
        counts[i] = below(2) ? 1 + below(2) * FRAME_MAX_RAY_LIGHTS : 0;
    if (scene->counts.ranged_lights > scene->counts.lights)
        scene->counts.ranged_lights = scene->counts.lights;
    scene->environment = below(2);
    scene->cascaded_shadow = below(2);
    scene->color_classes = below(6);
    scene->data_classes = below(6);
    scene->texture_transforms = below(2);
    scene->second_uv_set = below(2);
}

// Each setting that is a choice; a switch differs from its default in one frame of four. Numbers
// select no code but by being small.
static void random_settings(struct render_settings *settings)
{
    render_settings_init(settings);
#define RANDOM_FLOAT      before
#define RANDOM_INT        below(3)
#define RANDOM_BOOL       (before != 0) != (below(4) == 0)
#define RANDOM_ENUM(kind) (enum kind) below(sizeof(kind##_names) / sizeof(kind##_names[0]) - 1)
#define PARAMETER(record, name, type, ...)                                                         \
    {                                                                                              \
        const float before = (float)settings->name;                                                \
        (void)before;                                                                              \
        settings->name = RANDOM_##type;                                                            \
    }
#include "protocol/parameters/settings.def"
#undef PARAMETER
}

// A plan of a random frame. `out_in` stays valid until the next call.
static void random_plan(struct frame_plan *plan, struct frame_inputs *out_in)
{
    static struct frame_params params;
    static struct frame_history history;
    static const struct scene_revisions revisions;
    params.width = params.height = 64;
    params.quality = (enum quality)below(QUALITY_COUNT);
    params.debug_view = below(3) ? DEBUG_VIEW_FINAL : (enum debug_view)below(DEBUG_VIEW_COUNT);
    params.debug_level = below(4);
    params.output = (enum frame_output)below(3);
    random_settings(&params.settings);
    params.settings.gamma = below(2) ? 2.2f : 0.0f;
    history = (struct frame_history){.drawn = below(4) > 0, .params = params};
    history.accumulation.samples = below(80);
    static struct gi_state gi;
    gi = (struct gi_state){
        .serial = 1,
        .level_count = 1 + below(3),
        .cell_level_count = 1 + below(2),
        .light_converged = below(4) > 0,
        .work = {.voxelize = below(2),
                 .relight = below(2),
                 .direct = below(2),
                 .inject_bounce = below(2),
                 .fresh_only = below(2),
                 .trace = below(2)},
    };
    struct frame_inputs in = {.params = &params,
                              .revisions = &revisions,
                              .history = &history,
                              .target_width = 64,
                              .gi_capabilities =
                                  gi_methods[params.settings.gi_method]->capabilities,
                              .shadows_stale = below(2),
                              .transparent_in_view = below(2)};
    random_scene(&in.scene);
    in.reference_shown = (in.gi_capabilities & GI_IS_REFERENCE) && below(2);
    frame_plan_make(plan, &in);
    bool has_cones = in.gi_capabilities & GI_HAS_CONES;
    in.gi = plan->effects.calls_for_cones || (!has_cones && below(2)) ? &gi : NULL;
    frame_plan_make(plan, &in);
    *out_in = in;
}

struct tally {
    struct gpu *gpu;
    struct set *seen;  // permutations
    struct set *pairs; // of lines, compiled together
    uint32_t reached[PASS_COUNT][PASS_MAX_PROGRAMS];
    uint32_t compiled, failed;
};

// What a permutation reads must be there. Storage blocks do not tell: those of included files count
// as active, used or not.
static void check_buffers(struct tally *tally, const struct gpu_program *program,
                          const struct frame_inputs *in, const struct frame_plan *plan,
                          const char *path)
{
    const struct gpu_program_bindings *bound = gpu_program_get_bindings(program);
    for (int i = 0; i < RESOURCE_COUNT; i++) {
        const struct resource_row *row = &resource_rows[i];
        // Passes run the programs that add samples only in frames that do.
        if (i == RESOURCE_ACCUMULATION && !plan->accumulation.sample)
            continue;
        if ((bound->units & row->units) && row->bytes && row->bytes(in, plan) == 0) {
            tally->failed++;
            print_error("%s uses %s, which takes no memory in this frame\n", path, row->name);
        }
    }
}

// Names in the #if lines of a shader itself are defined: a program that does not list an effect
// would leave its code out in silence.
static void check_names(struct tally *tally, const char *path, const char *defines)
{
    const char *const texts[] = {defines};
    struct error error = {""};
    struct shader_source whole;
    char full[512], line[512];
    if (!shader_source_read(&whole, gpu_get_shader_dir(tally->gpu), path, texts, 1, &error))
        fail_msg("%s", error.message);
    snprintf(full, sizeof(full), "%s/%s", gpu_get_shader_dir(tally->gpu), path);
    FILE *file = fopen(full, "r");
    assert_non_null(file);
    while (fgets(line, sizeof(line), file)) {
        if (strncmp(line, "#if ", 4) != 0 && strncmp(line, "#elif ", 6) != 0)
            continue;
        line[strcspn(line, "/\n")] = '\0'; // comments
        for (char *name = strtok(line, " !()&|=<>"); name; name = strtok(NULL, " !()&|=<>")) {
            char define[128];
            snprintf(define, sizeof(define), "#define %s ", name);
            if (name[0] >= 'A' && name[0] <= 'Z' && !strstr(whole.text, define)) {
                tally->failed++;
                print_error("%s: %s is not defined\n", path, name);
            }
        }
    }
    fclose(file);
    shader_source_finish(&whole);
}

static void compile(struct tally *tally, enum pass_id pass, const struct shader_program *shader,
                    const char *defines, const struct frame_inputs *in,
                    const struct frame_plan *plan)
{
    struct error error = {""};
    const struct gpu_program *program = gpu_program_get(tally->gpu, shader->path, defines, &error);
    tally->compiled++;
    if (!program) {
        tally->failed++;
        print_error("%s\nwith\n%s\n", error.message, defines);
        return;
    }
    const char *undeclared = pass_find_undeclared(all_passes[pass], program);
    if (undeclared) {
        tally->failed++;
        print_error("pass %s does not declare %s\n", pass_name(pass), undeclared);
    }
    check_buffers(tally, program, in, plan, shader->path);
}

static void take_plan(struct tally *tally, const struct frame_inputs *in,
                      const struct frame_plan *plan)
{
    for (int i = 0; i < PASS_COUNT; i++) {
        const struct pass *pass = all_passes[i];
        for (uint32_t j = 0; frame_plan_runs(plan, (enum pass_id)i) && j < pass->program_count;
             j++) {
            char defines[PROGRAM_DEFINES_BYTES];
            uint64_t program = (uint64_t)i * PASS_MAX_PROGRAMS + j;
            shader_program_write_defines(&pass->programs[j], plan, defines);
            assert_true(strlen(defines) < PROGRAM_DEFINES_BYTES - 1);
            uint64_t hash = hash_word(HASH_START, program);
            if (!add(tally->seen, hash_text(hash, defines, strlen(defines)) | 1))
                continue;
            bool few = ++tally->reached[i][j] <= FEW;
            if (add_pairs(tally->pairs, program, defines) > 0 || few)
                compile(tally, (enum pass_id)i, &pass->programs[j], defines, in, plan);
            if (tally->reached[i][j] == 1 && strstr(pass->programs[j].path, ".comp"))
                check_names(tally, pass->programs[j].path, defines);
        }
    }
}

static void test_reachable_permutations_compile(void **state)
{
    (void)state;
    struct error error = {""};
    const char *folder = getenv("VOXCAST_SHADER_DIR");
    struct tally tally = {
        .gpu = gpu_create("auto", folder ? folder : VOXCAST_SOURCE_DIR "/shaders", &error),
        .seen = calloc(1, sizeof(*tally.seen)),
        .pairs = calloc(1, sizeof(*tally.pairs)),
    };
    if (!tally.gpu)
        fail_msg("%s", error.message);
    assert_true(passes_prepare_gpu(tally.gpu));
    assert_non_null(tally.seen);
    assert_non_null(tally.pairs);
    for (int i = 0; i < FRAMES; i++) {
        struct frame_plan plan;
        struct frame_inputs in;
        random_plan(&plan, &in);
        take_plan(&tally, &in, &plan);
    }
    for (int i = 0; i < PASS_COUNT; i++)
        for (uint32_t j = 0; j < all_passes[i]->program_count; j++)
            if (tally.reached[i][j] == 0)
                fail_msg("no frame runs program %u of pass %s", j, pass_name((enum pass_id)i));
    printf("  %u permutations reached, %u compiled\n", tally.seen->count, tally.compiled);
    assert_int_equal(tally.failed, 0);
    assert_int_equal(gpu_error_count(tally.gpu), 0);
    gpu_destroy(&tally.gpu);
    free(tally.seen);
    free(tally.pairs);
}

static void test_a_resource_that_is_not_declared_is_found(void **state)
{
    (void)state;
    struct error error = {""};
    struct gpu *gpu = gpu_create("auto", VOXCAST_SOURCE_DIR "/shaders", &error);
    if (!gpu)
        fail_msg("%s", error.message);
    assert_true(passes_prepare_gpu(gpu));
    struct pass pass = emission_pass;
    pass.reads &= ~RESOURCE(GBUFFER);
    const struct gpu_program *program = gpu_program_get(gpu, pass.programs[0].path, "", &error);
    assert_non_null(program);
    assert_string_equal(pass_find_undeclared(&pass, program), "gbuffer");
    gpu_destroy(&gpu);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_reachable_permutations_compile),
        cmocka_unit_test(test_a_resource_that_is_not_declared_is_found),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
