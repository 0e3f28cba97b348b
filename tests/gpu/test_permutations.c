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

#include "renderer/gpu/program.h"
#include "renderer/gpu/shader_source.h"
#include "support_gpu.h"
#include "support_permutations.h"

#define FEW 24 // permutations

struct tally {
    struct gpu *gpu;
    struct hash_set *pairs; // of lines, compiled together
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

static void compile(struct tally *tally, const struct permutation *permutation)
{
    struct error error = {""};
    const struct gpu_program *program =
        gpu_program_get(tally->gpu, permutation->shader->path, permutation->defines, &error);
    tally->compiled++;
    if (!program) {
        tally->failed++;
        print_error("%s\nwith\n%s\n", error.message, permutation->defines);
        return;
    }
    const char *undeclared = pass_find_undeclared(all_passes[permutation->pass], program);
    if (undeclared) {
        tally->failed++;
        print_error("pass %s does not declare %s\n", pass_name(permutation->pass), undeclared);
    }
    check_buffers(tally, program, permutation->in, permutation->plan, permutation->shader->path);
}

static void take_permutation(void *context, const struct permutation *permutation)
{
    struct tally *tally = context;
    const char *path = permutation->shader->path;
    uint32_t reached = ++tally->reached[permutation->pass][permutation->number];
    if (permutation_has_new_combination(tally->pairs, permutation, 2) || reached <= FEW)
        compile(tally, permutation);
    if (reached == 1 && strstr(path, ".comp"))
        check_names(tally, path, permutation->defines);
}

static void test_reachable_permutations_compile(void **state)
{
    (void)state;
    struct error error = {""};
    struct tally tally = {
        .gpu = gpu_create("auto", test_shader_dir(), &error),
        .pairs = calloc(1, sizeof(*tally.pairs)),
    };
    if (!tally.gpu)
        fail_msg("%s", error.message);
    assert_true(passes_prepare_gpu(tally.gpu));
    assert_non_null(tally.pairs);
    uint32_t count = permutations_visit(take_permutation, &tally);
    for (int i = 0; i < PASS_COUNT; i++)
        for (uint32_t j = 0; j < all_passes[i]->program_count; j++)
            if (tally.reached[i][j] == 0)
                fail_msg("no frame runs program %u of pass %s", j, pass_name((enum pass_id)i));
    printf("  %u permutations reached, %u compiled\n", count, tally.compiled);
    assert_int_equal(tally.failed, 0);
    assert_int_equal(gpu_error_count(tally.gpu), 0);
    gpu_destroy(&tally.gpu);
    free(tally.pairs);
}

static void test_a_resource_that_is_not_declared_is_found(void **state)
{
    (void)state;
    struct error error = {""};
    struct gpu *gpu = gpu_create("auto", test_shader_dir(), &error);
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
