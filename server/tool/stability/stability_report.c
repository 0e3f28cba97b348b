// Which cases run, and how results are reported: a table on stdout, results.json in the folder.
#include <cjson/cJSON.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <errno.h>

#include "renderer/clock.h"
#include "renderer/metrics/picture.h"
#include "server/tool/stability/stability_internal.h"

// "holds", "known" (misses its bound, but not the value that it is held to meanwhile) or "fails".
static const char *state_of(const struct stability_run *run)
{
    if (run->failed || !run->measured_any)
        return "fails";
    if (run->measured <= stability_bound(run))
        return "holds";
    return run->measured <= run->test->known ? "known" : "fails";
}

static void print_run(const struct stability_run *run)
{
    const struct stability_case *test = run->test;
    const char *state = state_of(run);
    char bound[64];
    snprintf(bound, sizeof(bound), "%.4g", stability_bound(run));
    if (strcmp(state, "known") == 0)
        snprintf(bound, sizeof(bound), "%.4g (%.4g)", stability_bound(run), test->known);
    printf("%-6s %-28s %-9s %10.4g %16s %-18s %4u %6.1f s%s%s\n",
           strcmp(state, "holds") == 0 ? "ok" : state, test->name, gi_method_names[run->method],
           run->measured, bound, test->unit, run->frames, run->seconds,
           strcmp(state, "holds") == 0 ? "" : "  ", strcmp(state, "holds") == 0 ? "" : run->where);
    fflush(stdout);
}

static void add_result(struct stability *suite, const struct stability_run *run, uint32_t family)
{
    const struct stability_case *test = run->test;
    cJSON *item = cJSON_CreateObject();
    cJSON_AddStringToObject(item, "name", test->name);
    cJSON_AddStringToObject(item, "family", stability_tables[family]->name);
    cJSON_AddStringToObject(item, "title", stability_tables[family]->title);
    cJSON_AddStringToObject(item, "method", gi_method_names[run->method]);
    cJSON_AddStringToObject(item, "invariant", test->invariant);
    cJSON_AddNumberToObject(item, "measured", run->measured); // null if infinite
    cJSON_AddNumberToObject(item, "bound", stability_bound(run));
    if (test->known > 0.0)
        cJSON_AddNumberToObject(item, "known", test->known);
    cJSON_AddStringToObject(item, "unit", test->unit);
    cJSON_AddStringToObject(item, "state", state_of(run));
    cJSON_AddStringToObject(item, "where", run->where);
    cJSON_AddNumberToObject(item, "frames", run->frames);
    cJSON_AddNumberToObject(item, "bad_values", (double)run->bad_values);
    cJSON_AddNumberToObject(item, "cut_values", (double)run->cut_values);
    cJSON_AddNumberToObject(item, "seconds", round(run->seconds * 100.0) / 100.0);
    cJSON *pictures = cJSON_AddArrayToObject(item, "pictures");
    for (uint32_t i = 0; i < run->picture_count; i++)
        cJSON_AddItemToArray(pictures, cJSON_CreateString(run->pictures[i]));
    cJSON_AddItemToArray(suite->results, item);
}

static void run_case(struct stability *suite, const struct stability_case *test, uint32_t family,
                     enum gi_method method)
{
    struct stability_run run = {.suite = suite, .test = test, .method = method};
    double start_ms = clock_now_ms();
    test->run(&run);
    if (!run.measured_any && !run.failed)
        stability_fail(&run, "nothing was measured");
    if (run.measured_any && run.measured > 0.0 && !run.failed && run.where[0] == '\0')
        snprintf(run.where, sizeof(run.where), "-");
    run.seconds = (clock_now_ms() - start_ms) / 1e3;
    if (suite->renderer)
        snprintf(suite->gl_renderer, sizeof(suite->gl_renderer), "%s",
                 renderer_get_info(suite->renderer)->gl_renderer);
    suite->run_count++;
    suite->failures += strcmp(state_of(&run), "fails") == 0;
    suite->known += strcmp(state_of(&run), "known") == 0;
    print_run(&run);
    add_result(suite, &run, family);
}

static bool is_chosen(const struct stability_choice *choice, const struct stability_table *table,
                      const struct stability_case *test)
{
    return (!choice->name || strcmp(choice->name, test->name) == 0) &&
           (!choice->family || strcmp(choice->family, table->name) == 0);
}

static uint32_t run_chosen(struct stability *suite, const struct stability_choice *choice)
{
    uint32_t cases = 0;
    for (uint32_t family = 0; family < stability_table_count; family++)
        for (uint32_t i = 0; i < stability_tables[family]->count; i++) {
            const struct stability_case *test = &stability_tables[family]->cases[i];
            if (!is_chosen(choice, stability_tables[family], test))
                continue;
            cases++;
            for (int method = 0; method < GI_METHOD_COUNT; method++)
                if (test->methods & (1u << method))
                    run_case(suite, test, family, (enum gi_method)method);
        }
    return cases;
}

bool stability_write_results(const struct stability *suite, struct error *out_error)
{
    char path[4096];
    snprintf(path, sizeof(path), "%s/results.json", suite->folder);
    cJSON *root = cJSON_CreateObject();
    cJSON_AddStringToObject(root, "program", "voxcast " VOXCAST_VERSION);
    cJSON_AddStringToObject(root, "gl_renderer", suite->gl_renderer);
    cJSON_AddNumberToObject(root, "seconds", round(suite->seconds));
    cJSON_AddItemReferenceToObject(root, "cases", suite->results);
    char *text = cJSON_Print(root);
    cJSON_Delete(root);
    FILE *file = text ? fopen(path, "w") : NULL;
    bool done = file && fputs(text, file) >= 0 && fputc('\n', file) >= 0;
    done = (!file || fclose(file) == 0) && done;
    cJSON_free(text);
    return done || error_set(out_error, "cannot write \"%s\": %m", path);
}

// Creates the folder and its parents.
static bool make_folders(const char *folder)
{
    char path[4096];
    snprintf(path, sizeof(path), "%s", folder);
    for (char *at = path + 1; *at; at++) {
        if (*at != '/')
            continue;
        *at = '\0';
        if (mkdir(path, 0777) != 0 && errno != EEXIST)
            return false;
        *at = '/';
    }
    return mkdir(path, 0777) == 0 || errno == EEXIST;
}

bool stability_run_cases(const struct stability_choice *choice, uint32_t *out_failures,
                         struct error *out_error)
{
    struct stability suite = {.gpu = choice->gpu, .folder = choice->folder};
    if (choice->folder && !make_folders(choice->folder))
        return error_set(out_error, "cannot make the folder \"%s\": %m", choice->folder);
    suite.results = cJSON_CreateArray();
    double start_ms = clock_now_ms();
    printf("%-6s %-28s %-9s %10s %16s %-18s %4s %8s\n", "", "case", "method", "measured", "bound",
           "unit", "frms", "time");
    bool done = run_chosen(&suite, choice) > 0;
    if (!done)
        error_set(out_error, "there is no case \"%.100s\"%s%.100s%s",
                  choice->name ? choice->name : "any", choice->family ? " in family \"" : "",
                  choice->family ? choice->family : "", choice->family ? "\"" : "");
    stability_end_renderer(&suite);
    for (int method = 0; method < GI_METHOD_COUNT; method++)
        picture_finish(&suite.usual[method]);
    suite.seconds = (clock_now_ms() - start_ms) / 1e3;
    if (done)
        printf("%u runs, %u fail, %u known to miss their bound, %.0f s\n", suite.run_count,
               suite.failures, suite.known, suite.seconds);
    if (done && suite.folder)
        done = stability_write_results(&suite, out_error);
    cJSON_Delete(suite.results);
    *out_failures = suite.failures;
    return done;
}
