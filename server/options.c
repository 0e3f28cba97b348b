#include "server/options.h"

#include <ctype.h>
#include <errno.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "protocol/limits.h"
#include "server/stream/frame_stream.h"
#include "server/stream/encode_workers.h"

enum option_kind { OPTION_TEXT, OPTION_NUMBER, OPTION_LOG_LEVEL };

struct option_row {
    const char *name; // of the flag, without "--", and of the key in the file
    enum option_kind kind;
    size_t offset;
    const char *fallback;
    uint32_t min, max;
    const char *value_name;
    const char *help;
};

#define TEXT(name, field, fallback, value, help)                                                   \
    {                                                                                              \
        name, OPTION_TEXT, offsetof(struct options, field), fallback, 0, 0, value, help            \
    }
#define NUMBER(name, field, fallback, min, max, help)                                              \
    {                                                                                              \
        name, OPTION_NUMBER, offsetof(struct options, field), fallback, min, max, "N", help        \
    }

static const struct option_row rows[] = {
    TEXT("scene", scene, OPTIONS_DEFAULT_SCENE, "SCENE",
         "file or builtin:NAME; also without --scene"),
    TEXT("environment", environment, "", "FILE", ".hdr or .exr image that lights that scene"),
    TEXT("listen", listen, "127.0.0.1", "ADDRESS", "address to listen on"),
    NUMBER("port", port, "8080", 0, 65535, "TCP port; 0 takes a free one and prints it"),
    TEXT("gpu", gpu, "auto", "DEVICE", "auto, software, or the number of a device"),
    TEXT("scene-dir", scene_dir, "", "FOLDER", "scenes that clients may load, and no others"),
    TEXT("web-dir", web_dir, "", "FOLDER", "the web client; default: the installed one"),
    TEXT("token-file", token_file, "", "FILE", "clients must bring the token in this file"),
    TEXT("viewer-token-file", viewer_token_file, "", "FILE",
         "a token whose clients may look but not edit"),
    TEXT("allow-origin", allow_origin, "", "LIST",
         "web origins allowed beside our own, commas between"),
    NUMBER("max-clients", max_clients, "16", 1, FRAME_STREAM_MAX_CLIENTS, "clients at once"),
    NUMBER("message-bytes", message_bytes, "65536", 1024, PROTOCOL_MAX_MESSAGE_BYTES,
           "largest message of a client"),
    NUMBER("queue-bytes", queue_bytes, "67108864", 1u << 20, 1u << 30,
           "replies that may wait for one client; beyond, it is hung up on"),
    NUMBER("message-rate", message_rate, "240", 1, 100000, "messages a second of one client"),
    NUMBER("scene-cache-mib", scene_cache_mib, "2048", 0, SCENE_CACHE_MAX_MIB,
           "limit of what is kept on disk to open scenes faster; 0: nothing"),
    NUMBER("jpeg-quality", jpeg_quality, "85", 1, 100, "quality of the frames"),
    NUMBER("jpeg-threads", jpeg_threads, "2", 1, ENCODE_MAX_WORKERS, "threads that encode frames"),
    {"log-level", OPTION_LOG_LEVEL, offsetof(struct options, log_level), "info", 0, 0, "LEVEL",
     "error, warn, info or debug"},
};

_Static_assert(SCENE_CACHE_DEFAULT_MIB == 2048, "the table says so in words");

#define ROW_COUNT (sizeof(rows) / sizeof(rows[0]))

static const struct option_row *find_row(const char *name, size_t length)
{
    for (size_t i = 0; i < ROW_COUNT; i++) {
        if (strlen(rows[i].name) == length && strncmp(rows[i].name, name, length) == 0)
            return &rows[i];
    }
    return NULL;
}

static bool set_number(const struct option_row *row, void *field, const char *value,
                       const char *where, struct error *error)
{
    char *end = NULL;
    errno = 0;
    unsigned long number = strtoul(value, &end, 10);
    if (!isdigit((unsigned char)value[0]) || *end != '\0' || errno != 0 || number < row->min ||
        number > row->max)
        return error_set(error, "%s: %s is \"%.100s\"; allowed are %u to %u", where, row->name,
                         value, row->min, row->max);
    *(uint32_t *)field = (uint32_t)number;
    return true;
}

static bool set_log_level(const struct option_row *row, void *field, const char *value,
                          const char *where, struct error *error)
{
    static const char *const names[] = {"error", "warn", "info", "debug"};
    for (int i = 0; i < 4; i++) {
        if (strcmp(names[i], value) == 0) {
            *(enum log_level *)field = (enum log_level)i;
            return true;
        }
    }
    return error_set(error, "%s: %s is \"%.100s\"; allowed are error, warn, info, debug", where,
                     row->name, value);
}

static bool set_option(struct options *options, const struct option_row *row, const char *value,
                       const char *where, struct error *error)
{
    void *field = (char *)options + row->offset;
    if (row->kind == OPTION_NUMBER)
        return set_number(row, field, value, where, error);
    if (row->kind == OPTION_LOG_LEVEL)
        return set_log_level(row, field, value, where, error);
    if (strlen(value) >= OPTIONS_TEXT_SIZE)
        return error_set(error, "%s: %s is longer than %u bytes", where, row->name,
                         OPTIONS_TEXT_SIZE - 1);
    strcpy(field, value);
    return true;
}

static char *trim(char *text)
{
    while (isspace((unsigned char)*text))
        text++;
    size_t length = strlen(text);
    while (length > 0 && isspace((unsigned char)text[length - 1]))
        text[--length] = '\0';
    return text;
}

static bool read_line(struct options *options, char *line, const char *where, struct error *error)
{
    line = trim(line);
    if (line[0] == '\0' || line[0] == '#')
        return true;
    char *equals = strchr(line, '=');
    if (!equals)
        return error_set(error, "%s: want key = value", where);
    *equals = '\0';
    char *key = trim(line);
    const struct option_row *row = find_row(key, strlen(key));
    if (!row)
        return error_set(error, "%s: unknown option \"%.100s\"", where, key);
    return set_option(options, row, trim(equals + 1), where, error);
}

static bool read_file(struct options *options, const char *path, struct error *error)
{
    FILE *file = fopen(path, "r");
    if (!file)
        return error_set(error, "config file %.200s: %s", path, strerror(errno));
    char line[OPTIONS_TEXT_SIZE + 64];
    bool fine = true;
    for (int number = 1; fine && fgets(line, sizeof(line), file); number++) {
        char where[300];
        snprintf(where, sizeof(where), "%.200s:%d", path, number);
        fine = strchr(line, '\n') || feof(file)
                   ? read_line(options, line, where, error)
                   : error_set(error, "%s: longer than %zu bytes", where, sizeof(line) - 2);
    }
    if (fine && ferror(file))
        fine = error_set(error, "config file %.200s: %s", path, strerror(errno));
    fclose(file);
    return fine;
}

// For example, VOXCASTD_MAX_CLIENTS=4 means max-clients = 4.
static bool read_environment(struct options *options, char *const *environment, struct error *error)
{
    for (; environment && *environment; environment++) {
        const char *equals = strchr(*environment, '=');
        if (!equals || strncmp(*environment, "VOXCASTD_", 9) != 0)
            continue;
        char key[64] = "";
        size_t length = (size_t)(equals - *environment) - 9;
        for (size_t i = 0; i < length && i < sizeof(key) - 1; i++) {
            char c = (*environment)[9 + i];
            key[i] = c == '_' ? '-' : (char)tolower((unsigned char)c);
        }
        if (strcmp(key, "config") == 0)
            continue;
        const struct option_row *row = find_row(key, strlen(key));
        if (!row)
            return error_set(error, "environment: unknown option %.*s",
                             (int)(equals - *environment), *environment);
        if (!set_option(options, row, equals + 1, "environment", error))
            return false;
    }
    return true;
}

// Handles one flag at `*index` and moves the index to the last argument used.
static bool read_flag(struct options *options, int count, char *const *arguments, int *index,
                      struct error *error)
{
    const char *argument = arguments[*index];
    if (strncmp(argument, "--", 2) != 0) {
        if (argument[0] == '-')
            return error_set(error, "unknown option %.100s; see --help", argument);
        return set_option(options, &rows[0], argument, "command line", error);
    }
    const char *equals = strchr(argument, '=');
    size_t length = equals ? (size_t)(equals - argument) - 2 : strlen(argument) - 2;
    bool config = length == 6 && strncmp(argument + 2, "config", 6) == 0;
    const struct option_row *row = find_row(argument + 2, length);
    if (!row && !config)
        return error_set(error, "unknown option %.100s; see --help", argument);
    const char *value = equals ? equals + 1 : NULL;
    if (!value && *index + 1 < count)
        value = arguments[++*index];
    if (!value)
        return error_set(error, "%.100s wants a value", argument);
    return config || set_option(options, row, value, "command line", error);
}

static const char *find_config(int count, char *const *arguments, char *const *environment)
{
    for (int i = 1; i < count; i++) {
        if (strncmp(arguments[i], "--config=", 9) == 0)
            return arguments[i] + 9;
        if (strcmp(arguments[i], "--config") == 0 && i + 1 < count)
            return arguments[i + 1];
    }
    for (; environment && *environment; environment++) {
        if (strncmp(*environment, "VOXCASTD_CONFIG=", 16) == 0)
            return *environment + 16;
    }
    return NULL;
}

enum options_result options_read(int argument_count, char *const *arguments,
                                 char *const *environment, struct options *out_options,
                                 struct error *out_error)
{
    for (int i = 1; i < argument_count; i++) {
        if (strcmp(arguments[i], "--help") == 0 || strcmp(arguments[i], "-h") == 0)
            return OPTIONS_HELP;
        if (strcmp(arguments[i], "--version") == 0)
            return OPTIONS_VERSION;
    }
    memset(out_options, 0, sizeof(*out_options));
    for (size_t i = 0; i < ROW_COUNT; i++)
        set_option(out_options, &rows[i], rows[i].fallback, "default", out_error);
    const char *config = find_config(argument_count, arguments, environment);
    if (config && !read_file(out_options, config, out_error))
        return OPTIONS_WRONG;
    if (!read_environment(out_options, environment, out_error))
        return OPTIONS_WRONG;
    for (int i = 1; i < argument_count; i++) {
        if (!read_flag(out_options, argument_count, arguments, &i, out_error))
            return OPTIONS_WRONG;
    }
    return OPTIONS_RUN;
}

void options_write_help(char *out, size_t size)
{
    size_t used = (size_t)snprintf(out, size,
                                   "voxcastd " VOXCAST_VERSION "\n"
                                   "usage: voxcastd [SCENE] [--OPTION VALUE]...\n"
                                   "Renders a scene and streams it to browsers.\n\n"
                                   "Each option can also stand in a file (--config FILE, lines "
                                   "such as \"port = 8080\") and in\n"
                                   "the environment (VOXCASTD_PORT=8080). Flags win, then the "
                                   "environment, then the file.\n\n");
    for (size_t i = 0; i < ROW_COUNT && used < size; i++) {
        char flag[64];
        snprintf(flag, sizeof(flag), "--%s %s", rows[i].name, rows[i].value_name);
        used += (size_t)snprintf(out + used, size - used, "  %-28s %s", flag, rows[i].help);
        if (rows[i].fallback[0] && used < size)
            used += (size_t)snprintf(out + used, size - used, " [%s]", rows[i].fallback);
        if (used < size)
            used += (size_t)snprintf(out + used, size - used, "\n");
    }
    if (used < size)
        snprintf(out + used, size - used, "  %-28s %s\n", "--version", "print the version");
}
