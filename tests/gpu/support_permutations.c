#include "support_permutations.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "renderer/gi/gi_method.h"
#include "renderer/hash.h"

#define FRAMES    40000
#define MAX_LINES 32

static uint64_t seed = 1;

static uint32_t below(uint32_t end)
{
    seed = seed * 6364136223846793005ull + 1442695040888963407ull;
    return (uint32_t)((seed >> 33) % end);
}

bool hash_set_add(struct hash_set *set, uint64_t hash)
{
    hash |= 1; // no slot that is taken is 0
    uint32_t at = (uint32_t)(hash ^ hash >> 32) % PERMUTATION_SET_SIZE;
    while (set->slots[at] != 0 && set->slots[at] != hash)
        at = (at + 1) % PERMUTATION_SET_SIZE;
    if (set->slots[at] == hash)
        return false;
    set->slots[at] = hash;
    assert_true(++set->count < PERMUTATION_SET_SIZE / 2);
    return true;
}

static uint64_t program_hash(const struct permutation *permutation)
{
    return hash_word(HASH_START,
                     (uint64_t)permutation->pass * PASS_MAX_PROGRAMS + permutation->number);
}

// Adds each choice of `depth` lines from `first` on, in which one may recur. Returns
// whether any is new.
static bool add_combinations(struct hash_set *known, uint64_t hash, const uint64_t *lines,
                             uint32_t first, uint32_t count, uint32_t depth)
{
    bool found = false;
    if (depth == 0)
        return hash_set_add(known, hash);
    for (uint32_t i = first; i < count; i++)
        found |= add_combinations(known, hash_word(hash, lines[i]), lines, i, count, depth - 1);
    return found;
}

bool permutation_has_new_combination(struct hash_set *known, const struct permutation *permutation,
                                     uint32_t depth)
{
    uint64_t lines[MAX_LINES];
    uint32_t count = 0;
    for (const char *line = permutation->defines; *line;) {
        size_t length = strcspn(line, "\n");
        assert_true(count < MAX_LINES);
        lines[count++] = hash_bytes(HASH_START, line, length);
        line += length + (line[length] == '\n');
    }
    return add_combinations(known, program_hash(permutation), lines, 0, count, depth);
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

uint32_t permutations_visit(void (*take)(void *context, const struct permutation *permutation),
                            void *context)
{
    struct hash_set *seen = calloc(1, sizeof(*seen));
    assert_non_null(seen);
    for (int i = 0; i < FRAMES; i++) {
        struct frame_plan plan;
        struct frame_inputs in;
        random_plan(&plan, &in);
        for (int j = 0; j < PASS_COUNT; j++)
            for (uint32_t k = 0;
                 frame_plan_runs(&plan, (enum pass_id)j) && k < all_passes[j]->program_count; k++) {
                char defines[PROGRAM_DEFINES_BYTES];
                const struct shader_program *shader = &all_passes[j]->programs[k];
                const struct permutation permutation = {(enum pass_id)j, k,   shader,
                                                        defines,         &in, &plan};
                shader_program_write_defines(shader, &plan, defines);
                assert_true(strlen(defines) < PROGRAM_DEFINES_BYTES - 1);
                if (hash_set_add(seen,
                                 hash_bytes(program_hash(&permutation), defines, strlen(defines))))
                    take(context, &permutation);
            }
    }
    uint32_t count = seen->count;
    free(seen);
    return count;
}
