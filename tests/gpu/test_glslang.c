// Proves that shaders are GLSL 4.50 core as glslang reads it, whose front end is stricter than
// those of drivers: what Mesa or NVIDIA let pass fails here. glslangValidator gets the very texts
// that the driver gets, in two ways:
//  - the grammar and meaning of each text, of all permutations that have values of two defines
//    together that none before had, 200 texts a process, since a process takes 100 ms to begin and
//    a text 6 ms;
//  - of each program the permutation with the most defines that are not 0, 200 ms each, as a whole,
//    linked and made into SPIR-V by the rules of GL (ARB_gl_spirv): no recursion, what stages pass
//    on agrees, and all that is bound says where, rather than by names that drivers number.
// Warnings count as errors. Texts that fail stay in a folder below TMPDIR.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

#include "renderer/gpu/program.h"
#include "renderer/gpu/shader_source.h"
#include "support_gpu.h"
#include "support_permutations.h"

#define MAX_TEXTS   16384
#define MAX_PRINTED 20

struct dump {
    struct gpu *gpu;
    char folder[256];
    struct hash_set *pairs;
    struct {
        const struct shader_program *shader; // NULL if none was reached
        uint32_t set;                        // defines that are not 0
        char defines[PROGRAM_DEFINES_BYTES];
    } fullest[PASS_COUNT][PASS_MAX_PROGRAMS];
    FILE *texts;    // a line a text
    FILE *programs; // a line a program: its one text or two
    uint32_t count;
    struct {
        char path[64];
        char *defines; // owned
    } written[MAX_TEXTS];
};

static FILE *open_file(const struct dump *dump, const char *name, const char *mode)
{
    char path[512];
    snprintf(path, sizeof(path), "%s/%s", dump->folder, name);
    FILE *file = fopen(path, mode);
    if (!file)
        fail_msg("cannot open %s", path);
    return file;
}

// Writes the text as NUMBER.STAGE, and its name to one list or the other.
static void write_stage(struct dump *dump, const char *path, const char *defines, bool link)
{
    struct error error = {""};
    struct shader_source source;
    char name[64];
    if (!gpu_program_read_stage(dump->gpu, path, defines, &source, &error))
        fail_msg("%s", error.message);
    assert_true(dump->count < MAX_TEXTS);
    snprintf(dump->written[dump->count].path, sizeof(dump->written[0].path), "%s", path);
    dump->written[dump->count].defines = strdup(defines);
    snprintf(name, sizeof(name), "%u%s", dump->count, strrchr(path, '.'));
    FILE *file = open_file(dump, name, "w");
    fputs(source.text, file);
    assert_int_equal(fclose(file), 0);
    shader_source_finish(&source);
    // Blanks at the end of a line would join it to the next.
    if (link)
        fprintf(dump->programs, "%s%s", strcmp(strrchr(path, '.'), ".frag") == 0 ? " " : "", name);
    else
        fprintf(dump->texts, "%s\n", name);
    dump->count++;
}

static void write_program(struct dump *dump, const char *path, const char *defines, bool link)
{
    const char *const stages[] = {".vert", ".frag"};
    bool compute = strstr(path, ".comp");
    for (uint32_t i = 0; i < (compute ? 1 : 2); i++) {
        char full[128];
        snprintf(full, sizeof(full), "%s%s", path, compute ? "" : stages[i]);
        write_stage(dump, full, defines, link);
    }
    if (link)
        fputc('\n', dump->programs);
}

static uint32_t count_set(const char *defines)
{
    uint32_t set = 0;
    for (const char *end; (end = strchr(defines, '\n')); defines = end + 1)
        set += end[-1] != '0' || end[-2] != ' ';
    return set;
}

static void take_permutation(void *context, const struct permutation *permutation)
{
    struct dump *dump = context;
    uint32_t set = count_set(permutation->defines), pass = permutation->pass;
    if (!dump->fullest[pass][permutation->number].shader ||
        set > dump->fullest[pass][permutation->number].set) {
        dump->fullest[pass][permutation->number].shader = permutation->shader;
        dump->fullest[pass][permutation->number].set = set;
        strcpy(dump->fullest[pass][permutation->number].defines, permutation->defines);
    }
    if (permutation_has_new_combination(dump->pairs, permutation, 2))
        write_program(dump, permutation->shader->path, permutation->defines, false);
}

static uint32_t write_fullest(struct dump *dump)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < PASS_COUNT; i++)
        for (uint32_t j = 0; j < PASS_MAX_PROGRAMS; j++)
            if (dump->fullest[i][j].shader) {
                write_program(dump, dump->fullest[i][j].shader->path, dump->fullest[i][j].defines,
                              true);
                count++;
            }
    return count;
}

// Runs the command on each line of the file `list`, on all processors.
static bool run(const struct dump *dump, const char *command, const char *list)
{
    char line[1024];
    snprintf(line, sizeof(line), "cd '%s' && xargs -P %ld %s <%s >>log 2>&1", dump->folder,
             sysconf(_SC_NPROCESSORS_ONLN), command, list);
    int status = system(line);
    if (status != 0)
        print_error("%s: exit status %d\n", command, WEXITSTATUS(status));
    return status == 0;
}

// Prints what the log complains of, with the paths of files rather than their numbers.
static uint32_t print_complaints(const struct dump *dump)
{
    char line[1024];
    uint32_t complaints = 0, text = 0;
    FILE *log = open_file(dump, "log", "r");
    while (fgets(line, sizeof(line), log)) {
        char *end, mapped[1024];
        unsigned long number = strtoul(line, &end, 10);
        if (*end == '.' && number < dump->count) // "12.comp": what follows is of it
            text = (uint32_t)number;
        const char *position = strstr(line, ": ");
        if (complaints >= MAX_PRINTED)
            break;
        if ((strncmp(line, "ERROR", 5) != 0 && strncmp(line, "WARNING", 7) != 0) || !position)
            continue;
        struct shader_source source;
        struct error error;
        if (!gpu_program_read_stage(dump->gpu, dump->written[text].path,
                                    dump->written[text].defines, &source, &error))
            fail_msg("%s", error.message);
        shader_source_map_log(&source, position + 2, mapped, sizeof(mapped));
        shader_source_finish(&source);
        complaints++;
        print_error("%u (%s): %s", text, dump->written[text].path, mapped);
    }
    fclose(log);
    return complaints;
}

static struct dump *dump_create(void)
{
    struct error error = {""};
    struct dump *dump = calloc(1, sizeof(*dump));
    assert_non_null(dump);
    const char *temporary = getenv("TMPDIR");
    snprintf(dump->folder, sizeof(dump->folder), "%s/voxcast-glslang-XXXXXX",
             temporary ? temporary : "/tmp");
    assert_non_null(mkdtemp(dump->folder));
    dump->gpu = gpu_create("auto", test_shader_dir(), &error);
    if (!dump->gpu)
        fail_msg("%s", error.message);
    assert_true(passes_prepare_gpu(dump->gpu));
    dump->pairs = calloc(1, sizeof(*dump->pairs));
    assert_non_null(dump->pairs);
    dump->texts = open_file(dump, "texts", "w");
    dump->programs = open_file(dump, "programs", "w");
    return dump;
}

static void dump_destroy(struct dump *dump, bool keep_files)
{
    char command[512];
    snprintf(command, sizeof(command), "rm -rf '%s'", dump->folder);
    if (keep_files)
        print_error("texts are in %s\n", dump->folder);
    else
        assert_int_equal(system(command), 0);
    for (uint32_t i = 0; i < dump->count; i++)
        free(dump->written[i].defines);
    free(dump->pairs);
    gpu_destroy(&dump->gpu);
    free(dump);
}

static void test_shaders_pass_the_strict_front_end(void **state)
{
    (void)state;
    struct dump *dump = dump_create();
    uint32_t reached = permutations_visit(take_permutation, dump);
    uint32_t texts = dump->count, programs = write_fullest(dump);
    fclose(dump->texts);
    fclose(dump->programs);
    bool read = run(dump, "-n 200 glslangValidator", "texts");
    bool linked = run(dump, "-L 1 glslangValidator -G -o /dev/null", "programs");
    uint32_t complaints = print_complaints(dump);
    printf("  %u permutations reached, %u texts read, %u programs linked\n", reached, texts,
           programs);
    assert_true(programs > PASS_COUNT);
    dump_destroy(dump, complaints > 0 || !read || !linked);
    assert_int_equal(complaints, 0);
    assert_true(read && linked);
}

// What Mesa accepts and the standard does not.
static void test_what_drivers_let_pass_is_refused(void **state)
{
    (void)state;
    static const char *const bodies[] = {
        "uniform uint scale; shared uint sum; void main() { sum = scale; }", // no location
        "uint f(uint x); void main() { f(1u); } uint f(uint x) { return x == 0u ? 0u : f(x - 1u); "
        "}",
    };
    for (size_t i = 0; i < sizeof(bodies) / sizeof(bodies[0]); i++) {
        struct dump *dump = dump_create();
        FILE *file = open_file(dump, "0.comp", "w");
        fprintf(file, "#version 450 core\nlayout(local_size_x = 1) in;\n%s\n", bodies[i]);
        fclose(file);
        snprintf(dump->written[0].path, sizeof(dump->written[0].path), "post/tonemap.comp");
        dump->written[0].defines = strdup("");
        dump->count = 1;
        fputs("0.comp\n", dump->programs);
        fclose(dump->programs);
        fclose(dump->texts);
        assert_false(run(dump, "-L 1 glslangValidator -G -o /dev/null", "programs"));
        assert_true(print_complaints(dump) > 0);
        dump_destroy(dump, false);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_shaders_pass_the_strict_front_end),
        cmocka_unit_test(test_what_drivers_let_pass_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
