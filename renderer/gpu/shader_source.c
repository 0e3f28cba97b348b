#include "renderer/gpu/shader_source.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

struct text_builder {
    FILE *stream;
    struct shader_source *source;
    const char *folder;
};

static char *read_file(const char *folder, const char *path, struct error *out_error)
{
    char full[1400];
    snprintf(full, sizeof(full), "%s/%s", folder, path);
    FILE *file = fopen(full, "rb");
    if (!file) {
        error_set(out_error, "shader \"%s\" cannot be read in folder \"%s\"", path, folder);
        return NULL;
    }
    char *text = malloc(SHADER_MAX_FILE_BYTES);
    size_t size = text ? fread(text, 1, SHADER_MAX_FILE_BYTES - 1, file) : 0;
    fclose(file);
    if (text)
        text[size] = '\0';
    return text;
}

static bool expand(struct text_builder *builder, const char *path, int depth,
                   struct error *out_error);

// Name of an include line; false for any other line.
static bool parse_include(const char *line, size_t length, char out_name[SHADER_MAX_PATH])
{
    char copy[SHADER_MAX_PATH * 2];
    if (length >= sizeof(copy))
        return false;
    memcpy(copy, line, length);
    copy[length] = '\0';
    return sscanf(copy, " #include \"%255[^\"]\"", out_name) == 1;
}

static bool expand_lines(struct text_builder *builder, const char *path, char *text,
                         uint32_t file_number, int depth, struct error *out_error)
{
    int line_number = 1;
    fprintf(builder->stream, "#line 1 %u\n", file_number);
    for (char *line = text; *line; line_number++) {
        size_t length = strcspn(line, "\n");
        char name[SHADER_MAX_PATH];
        if (parse_include(line, length, name)) {
            if (!expand(builder, name, depth + 1, out_error)) {
                size_t used = out_error ? strlen(out_error->message) : 0;
                if (out_error && used < sizeof(out_error->message))
                    snprintf(out_error->message + used, sizeof(out_error->message) - used,
                             " (included at %s:%d)", path, line_number);
                return false;
            }
            fprintf(builder->stream, "#line %d %u\n", line_number + 1, file_number);
        } else {
            fwrite(line, 1, length, builder->stream);
            fputc('\n', builder->stream);
        }
        line += length + (line[length] == '\n');
    }
    return true;
}

static bool expand(struct text_builder *builder, const char *path, int depth,
                   struct error *out_error)
{
    struct shader_source *source = builder->source;
    for (uint32_t i = 0; i < source->file_count; i++)
        if (strcmp(source->files[i], path) == 0)
            return true; // include each file once
    if (depth > SHADER_MAX_DEPTH || source->file_count == SHADER_MAX_FILES)
        return error_set(out_error,
                         "shader \"%s\": includes nest deeper than %d or name over %d "
                         "files",
                         path, SHADER_MAX_DEPTH, SHADER_MAX_FILES);
    uint32_t number = source->file_count++;
    snprintf(source->files[number], SHADER_MAX_PATH, "%s", path);
    char *text = read_file(builder->folder, path, out_error);
    if (!text)
        return false;
    bool done = expand_lines(builder, path, text, number, depth, out_error);
    free(text);
    return done;
}

bool shader_source_read(struct shader_source *source, const char *folder, const char *path,
                        const char *const defines[], uint32_t define_count, struct error *out_error)
{
    *source = (struct shader_source){0};
    size_t size = 0;
    struct text_builder builder = {open_memstream(&source->text, &size), source, folder};
    if (!builder.stream)
        return error_set(out_error, "out of memory");
    fprintf(builder.stream, "#version 450 core\n");
    for (uint32_t i = 0; i < define_count; i++)
        for (const char *line = defines[i]; *line;) {
            size_t length = strcspn(line, "\n");
            fprintf(builder.stream, "#define %.*s\n", (int)length, line);
            line += length + (line[length] == '\n');
        }
    bool done = expand(&builder, path, 0, out_error);
    fclose(builder.stream);
    if (!done)
        shader_source_finish(source);
    return done;
}

void shader_source_finish(struct shader_source *source)
{
    free(source->text);
    source->text = NULL;
}

void shader_source_map_log(const struct shader_source *source, const char *log, char *out_text,
                           size_t out_size)
{
    size_t used = 0;
    bool line_start = true;
    while (*log && used + 1 < out_size) {
        char *end;
        unsigned long number = line_start && isdigit((unsigned char)*log) ? strtoul(log, &end, 10)
                                                                          : source->file_count;
        if (number < source->file_count && (*end == ':' || *end == '(')) {
            int written = snprintf(out_text + used, out_size - used, "%s", source->files[number]);
            used += (size_t)written < out_size - used ? (size_t)written : out_size - used - 1;
            log = end;
        }
        line_start = *log == '\n';
        if (*log)
            out_text[used++] = *log++;
        if (used >= out_size)
            used = out_size - 1;
    }
    out_text[used] = '\0';
}
