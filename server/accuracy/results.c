// Results of accuracy runs: kept between runs, written as JSON, as CSV and as a page.
#include <cjson/cJSON.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "renderer/metrics/image_metrics.h"
#include "server/accuracy/accuracy.h"
#include "voxcast_paths.h"

#define MAX_RESULT_BYTES (64u << 20)

static const char *const states[2] = {"cold", "converged"};
static const char *const parts[2] = {"metrics", "indirect"};

static const cJSON *get(const cJSON *object, const char *name)
{
    return cJSON_GetObjectItemCaseSensitive(object, name);
}

// The whole file, or NULL.
static char *read_text(const char *path)
{
    FILE *file = fopen(path, "rb");
    if (!file)
        return NULL;
    size_t length = 0;
    char *text = NULL;
    if (fseek(file, 0, SEEK_END) == 0) {
        long size = ftell(file);
        if (size > 0 && size <= (long)MAX_RESULT_BYTES && fseek(file, 0, SEEK_SET) == 0)
            text = calloc(1, (size_t)size + 1);
        if (text)
            length = fread(text, 1, (size_t)size, file);
    }
    fclose(file);
    if (length == 0) {
        free(text);
        return NULL;
    }
    return text;
}

// Whether both print the same text. NULL prints none.
static bool same_text(const cJSON *a, const cJSON *b)
{
    char *x = a ? cJSON_PrintUnformatted(a) : NULL, *y = b ? cJSON_PrintUnformatted(b) : NULL;
    bool same = x && y && strcmp(x, y) == 0;
    cJSON_free(x);
    cJSON_free(y);
    return same;
}

// Time of a frame and error of the final image; false if either has no value.
static bool get_point(const cJSON *entry, enum image_metric metric, double *out_ms,
                      double *out_error)
{
    const cJSON *ms = get(get(entry, "frame_ms"), "median");
    const cJSON *value =
        get(get(get(entry, "converged"), "metrics"), image_metric_infos[metric].name);
    if (!cJSON_IsNumber(ms) || !cJSON_IsNumber(value))
        return false;
    *out_ms = ms->valuedouble;
    *out_error = image_metric_error(metric, value->valuedouble);
    return true;
}

// The smallest error of a final image; infinite if there is none.
static double smallest_error(const cJSON *configurations, const char *part,
                             enum image_metric metric)
{
    const cJSON *entry;
    double smallest = INFINITY;
    cJSON_ArrayForEach(entry, configurations)
    {
        const cJSON *value =
            get(get(get(entry, "converged"), part), image_metric_infos[metric].name);
        if (cJSON_IsNumber(value))
            smallest = fmin(smallest, image_metric_error(metric, value->valuedouble));
    }
    return smallest;
}

// Says for each metric whether the reference image is accurate enough: whether its own error is
// small against the smallest error of a configuration.
static void judge_noise(cJSON *results)
{
    const cJSON *own = get(get(get(results, "setup"), "reference"), "error");
    cJSON_DeleteItemFromObjectCaseSensitive(results, "noise");
    cJSON *noise = cJSON_AddObjectToObject(results, "noise");
    for (int p = 0; p < 2; p++) {
        cJSON *part = cJSON_AddObjectToObject(noise, parts[p]);
        for (int i = 0; i < METRIC_NOT_FINITE; i++) {
            const cJSON *value = get(get(own, parts[p]), image_metric_infos[i].name);
            double smallest = smallest_error(get(results, "rungs"), parts[p], (enum image_metric)i);
            if (!cJSON_IsNumber(value) || !isfinite(smallest))
                continue;
            double error = image_metric_error((enum image_metric)i, value->valuedouble);
            cJSON *item = cJSON_AddObjectToObject(part, image_metric_infos[i].name);
            cJSON_AddNumberToObject(item, "reference", error);
            cJSON_AddNumberToObject(item, "smallest", smallest);
            cJSON_AddBoolToObject(item, "enough", error <= RESULTS_NOISE_FRACTION * smallest);
        }
    }
}

static cJSON *metric_list(void)
{
    cJSON *list = cJSON_CreateArray();
    for (int i = 0; i < METRIC_COUNT; i++) {
        cJSON *item = cJSON_CreateObject();
        cJSON_AddStringToObject(item, "name", image_metric_infos[i].name);
        cJSON_AddStringToObject(item, "title", image_metric_infos[i].title);
        cJSON_AddStringToObject(item, "unit", image_metric_infos[i].unit);
        cJSON_AddItemToArray(list, item);
    }
    return list;
}

cJSON *results_open(const char *folder, cJSON *setup, uint32_t *out_kept)
{
    char path[4096];
    snprintf(path, sizeof(path), "%s/results.json", folder);
    char *text = read_text(path);
    cJSON *former = text ? cJSON_Parse(text) : NULL;
    free(text);
    cJSON *results = cJSON_CreateObject();
    cJSON_AddItemToObject(results, "setup", setup);
    cJSON_AddItemToObject(results, "metrics", metric_list());
    // Printed and parsed again, so that both set-ups have gone through text.
    char *printed = cJSON_PrintUnformatted(setup);
    cJSON *parsed = printed ? cJSON_Parse(printed) : NULL;
    cJSON *configurations = NULL;
    if (same_text(get(former, "setup"), parsed) && cJSON_IsArray(get(former, "rungs")))
        configurations = cJSON_DetachItemFromObjectCaseSensitive(former, "rungs");
    cJSON_free(printed);
    cJSON_Delete(parsed);
    cJSON_Delete(former);
    cJSON_AddItemToObject(results, "rungs", configurations ? configurations : cJSON_CreateArray());
    judge_noise(results);
    *out_kept = (uint32_t)cJSON_GetArraySize(get(results, "rungs"));
    return results;
}

const cJSON *results_find(const cJSON *results, const struct configuration *configuration)
{
    cJSON *settings = configuration_json(configuration);
    const cJSON *entry, *found = NULL;
    cJSON_ArrayForEach(entry, get(results, "rungs"))
    {
        const char *name = cJSON_GetStringValue(get(entry, "name"));
        if (name && strcmp(name, configuration->name) == 0 &&
            same_text(get(entry, "settings"), settings))
            found = entry;
    }
    cJSON_Delete(settings);
    return found;
}

static bool is_on_front(const cJSON *configurations, const cJSON *entry, enum image_metric metric)
{
    const cJSON *other;
    double ms, error, other_ms, other_error;
    if (!get_point(entry, metric, &ms, &error))
        return false;
    cJSON_ArrayForEach(other, configurations)
    {
        if (!get_point(other, metric, &other_ms, &other_error))
            continue;
        if (other_ms <= ms && other_error <= error && (other_ms < ms || other_error < error))
            return false;
    }
    return true;
}

static void mark_front(cJSON *configurations)
{
    cJSON *entry;
    cJSON_ArrayForEach(entry, configurations)
    {
        cJSON *front = cJSON_CreateArray();
        for (int i = 0; i < METRIC_NOT_FINITE; i++)
            if (is_on_front(configurations, entry, (enum image_metric)i))
                cJSON_AddItemToArray(front, cJSON_CreateString(image_metric_infos[i].name));
        cJSON_DeleteItemFromObjectCaseSensitive(entry, "pareto");
        cJSON_AddItemToObject(entry, "pareto", front);
    }
}

void results_add(cJSON *results, cJSON *entry)
{
    cJSON *configurations = cJSON_GetObjectItemCaseSensitive(results, "rungs");
    const char *name = cJSON_GetStringValue(get(entry, "name"));
    for (int i = cJSON_GetArraySize(configurations) - 1; i >= 0; i--) {
        const char *other =
            cJSON_GetStringValue(get(cJSON_GetArrayItem(configurations, i), "name"));
        if (other && name && strcmp(other, name) == 0)
            cJSON_DeleteItemFromArray(configurations, i);
    }
    cJSON_AddItemToArray(configurations, entry);
    mark_front(configurations);
    judge_noise(results);
}

static void print_number(FILE *file, const cJSON *value)
{
    if (cJSON_IsNumber(value))
        fprintf(file, ",%.9g", value->valuedouble);
    else
        fputc(',', file);
}

static void print_csv_head(FILE *file)
{
    fputs("name,method,preset,scale,settings,frame_ms,frame_ms_p95,cold_ms,converged_ms,"
          "converged_frames,edit_first_ms,edit_arrived_ms,memory_bytes",
          file);
    for (int s = 0; s < 2; s++)
        for (int p = 0; p < 2; p++)
            for (int i = 0; i < METRIC_COUNT; i++)
                fprintf(file, ",%s_%s%s", states[s], p ? "indirect_" : "",
                        image_metric_infos[i].name);
    for (int i = 0; i < METRIC_NOT_FINITE; i++)
        fprintf(file, ",pareto_%s", image_metric_infos[i].name);
    fputc('\n', file);
}

static bool has_name(const cJSON *list, const char *name)
{
    const cJSON *item;
    cJSON_ArrayForEach(item, list)
    {
        if (cJSON_IsString(item) && strcmp(item->valuestring, name) == 0)
            return true;
    }
    return false;
}

static void print_csv_row(FILE *file, const cJSON *entry)
{
    const cJSON *settings = get(entry, "settings"), *set;
    const char *method = cJSON_GetStringValue(get(entry, "method"));
    const char *preset = cJSON_GetStringValue(get(settings, "preset"));
    fprintf(file, "%s,%s,%s", get(entry, "name")->valuestring, method ? method : "",
            preset ? preset : "");
    print_number(file, get(settings, "scale"));
    fputc(',', file);
    // Only vectors hold commas, and no field of settings is a vector.
    cJSON_ArrayForEach(set, get(settings, "set"))
    {
        fprintf(file, "%s%s=%s", set->prev && set != get(settings, "set")->child ? " " : "",
                set->string, cJSON_IsString(set) ? set->valuestring : "");
    }
    print_number(file, get(get(entry, "frame_ms"), "median"));
    print_number(file, get(get(entry, "frame_ms"), "p95"));
    print_number(file, get(get(entry, "cold"), "ms"));
    print_number(file, get(get(entry, "converged"), "ms"));
    print_number(file, get(get(entry, "converged"), "frames"));
    print_number(file, get(get(entry, "edit"), "first_ms"));
    print_number(file, get(get(entry, "edit"), "arrived_ms"));
    print_number(file, get(entry, "memory_bytes"));
    for (int s = 0; s < 2; s++)
        for (int p = 0; p < 2; p++)
            for (int i = 0; i < METRIC_COUNT; i++)
                print_number(file,
                             get(get(get(entry, states[s]), parts[p]), image_metric_infos[i].name));
    for (int i = 0; i < METRIC_NOT_FINITE; i++)
        fprintf(file, ",%d", has_name(get(entry, "pareto"), image_metric_infos[i].name));
    fputc('\n', file);
}

// Writes a file completely, or leaves it as it was.
struct safe_file {
    FILE *file;
    char path[4096], new_path[4096 + 8];
};

static bool open_file(struct safe_file *safe, const char *folder, const char *name,
                      struct error *out_error)
{
    snprintf(safe->path, sizeof(safe->path), "%s/%s", folder, name);
    snprintf(safe->new_path, sizeof(safe->new_path), "%s.new", safe->path);
    safe->file = fopen(safe->new_path, "wb");
    return safe->file ||
           error_set(out_error, "cannot write \"%.400s\": %s", safe->path, strerror(errno));
}

static bool close_file(struct safe_file *safe, bool done, struct error *out_error)
{
    done = !ferror(safe->file) && done;
    done = fclose(safe->file) == 0 && done;
    if (done && rename(safe->new_path, safe->path) == 0)
        return true;
    remove(safe->new_path);
    return error_set(out_error, "cannot write all of \"%.400s\" (disk full?)", safe->path);
}

static bool write_text(const char *folder, const char *name, const char *before, const char *text,
                       const char *after, struct error *out_error)
{
    struct safe_file safe;
    if (!open_file(&safe, folder, name, out_error))
        return false;
    bool done = text && fputs(before, safe.file) >= 0 && fputs(text, safe.file) >= 0 &&
                fputs(after, safe.file) >= 0;
    return close_file(&safe, done, out_error);
}

static bool write_csv(const cJSON *results, const char *folder, struct error *out_error)
{
    struct safe_file safe;
    const cJSON *entry;
    if (!open_file(&safe, folder, "results.csv", out_error))
        return false;
    print_csv_head(safe.file);
    cJSON_ArrayForEach(entry, get(results, "rungs"))
    {
        print_csv_row(safe.file, entry);
    }
    return close_file(&safe, true, out_error);
}

// The page's own files, from the source tree or from the installed folder.
static bool copy_report_file(const char *folder, const char *name, struct error *out_error)
{
    static const char *const sources[] = {VOXCAST_SOURCE_DIR "/web_client/report",
                                          VOXCAST_INSTALL_SHARE_DIR "/web_client/report"};
    char *text = NULL;
    for (size_t i = 0; i < 2 && !text; i++) {
        char path[4096];
        snprintf(path, sizeof(path), "%s/%s", sources[i], name);
        text = read_text(path);
    }
    bool done =
        text ? write_text(folder, name, "", text, "", out_error)
             : error_set(out_error, "%s/%s is missing; install voxcast again", sources[1], name);
    free(text);
    return done;
}

bool results_write(const cJSON *results, const char *folder, struct error *out_error)
{
    char *text = cJSON_Print(results);
    bool done = write_text(folder, "results.json", "", text, "\n", out_error);
    cJSON_free(text);
    return done;
}

bool results_write_report(const cJSON *results, const char *folder, struct error *out_error)
{
    char *text = cJSON_Print(results);
    // The page is opened from the disk, where it may load scripts but no JSON.
    bool done = write_text(folder, "results.js", "globalThis.results = ", text, ";\n", out_error);
    cJSON_free(text);
    return done && write_csv(results, folder, out_error) &&
           copy_report_file(folder, "index.html", out_error) &&
           copy_report_file(folder, "error_chart.js", out_error) &&
           copy_report_file(folder, "chart_view.js", out_error) &&
           copy_report_file(folder, "report.js", out_error);
}
