#include "server/tool/tool_options.h"

#include <assert.h>
#include <errno.h>
#include <getopt.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "server/accuracy/shot.h"
#include "server/document/document_text.h"
#include "server/tool/cli.h"

#define FIRST_LETTER 256 // beyond what getopt returns itself
#define HELP_LETTER  255

static void take(struct cli_parser *parser, const struct cli_option *option)
{
    assert(parser->option_count < CLI_MAX_OPTIONS);
    parser->options[parser->option_count++] = *option;
}

void cli_take_text(struct cli_parser *parser, const char *name, const char **target)
{
    take(parser, &(struct cli_option){.name = name, .kind = CLI_OPTION_TEXT, .target = target});
}

void cli_take_flag(struct cli_parser *parser, const char *name, bool *target)
{
    take(parser, &(struct cli_option){.name = name, .kind = CLI_OPTION_FLAG, .target = target});
}

void cli_take_count(struct cli_parser *parser, const char *name, uint32_t low, uint32_t high,
                    uint32_t *target)
{
    take(parser,
         &(struct cli_option){
             .name = name, .kind = CLI_OPTION_COUNT, .target = target, .low = low, .high = high});
}

void cli_take_number(struct cli_parser *parser, const char *name, double low, double high,
                     double *target)
{
    take(parser,
         &(struct cli_option){
             .name = name, .kind = CLI_OPTION_NUMBER, .target = target, .low = low, .high = high});
}

void cli_take_vector(struct cli_parser *parser, const char *name, struct cli_vector *target)
{
    take(parser, &(struct cli_option){.name = name, .kind = CLI_OPTION_VECTOR, .target = target});
}

void cli_take_choice(struct cli_parser *parser, const char *name, const char *const *names,
                     uint32_t name_count, uint32_t *target)
{
    take(parser, &(struct cli_option){.name = name,
                                      .kind = CLI_OPTION_CHOICE,
                                      .target = target,
                                      .names = names,
                                      .name_count = name_count});
}

void cli_take_size(struct cli_parser *parser, struct cli_size *target)
{
    take(parser, &(struct cli_option){.name = "size", .kind = CLI_OPTION_SIZE, .target = target});
}

void cli_take_gpu(struct cli_parser *parser, const char **target)
{
    *target = "auto";
    cli_take_text(parser, "gpu", target);
}

void cli_take_preset(struct cli_parser *parser, uint32_t *target)
{
    cli_take_choice(parser, "preset", quality_names, QUALITY_COUNT, target);
}

void cli_take_gi(struct cli_parser *parser, uint32_t *target)
{
    cli_take_choice(parser, "gi", gi_method_names, GI_METHOD_COUNT, target);
}

void cli_take_camera(struct cli_parser *parser, struct cli_camera *target)
{
    cli_take_text(parser, "camera", &target->name);
    cli_take_vector(parser, "eye", &target->eye);
    cli_take_vector(parser, "target", &target->target);
    cli_take_vector(parser, "up", &target->up);
    cli_take_number(parser, "fov-y-deg", 0.1, 179.0, &target->fov_y_deg);
}

void cli_take_settings(struct cli_parser *parser, struct cli_settings *target)
{
    *target = (struct cli_settings){CLI_NO_CHOICE, CLI_NO_CHOICE, CLI_NO_CHOICE, {0}};
    cli_take_gi(parser, &target->gi);
    cli_take_preset(parser, &target->preset);
    cli_take_choice(parser, "view", debug_view_names, DEBUG_VIEW_COUNT, &target->view);
    take(parser,
         &(struct cli_option){.name = "set", .kind = CLI_OPTION_SETS, .target = &target->sets});
}

static bool read_number(const struct cli_option *option, const char *text, double *out_number,
                        struct error *out_error)
{
    char *end;
    double number = strtod(text, &end);
    bool whole = option->kind == CLI_OPTION_COUNT;
    if (end == text || *end != '\0' || !(number >= option->low && number <= option->high) ||
        (whole && number != floor(number)))
        return error_set(out_error, "--%s is \"%.200s\"; allowed: %.10g to %.10g", option->name,
                         text, option->low, option->high);
    *out_number = number;
    return true;
}

static bool read_vector(const struct cli_option *option, const char *text, struct error *out_error)
{
    float v[3];
    char extra;
    bool fine = sscanf(text, "%f,%f,%f%c", &v[0], &v[1], &v[2], &extra) == 3;
    for (int i = 0; i < 3 && fine; i++)
        fine = isfinite(v[i]);
    if (!fine)
        return error_set(out_error, "--%s is \"%.200s\"; three finite numbers X,Y,Z are needed",
                         option->name, text);
    struct cli_vector *vector = option->target;
    vector->given = true;
    memcpy(vector->xyz, v, sizeof(v));
    return true;
}

static bool read_size(const char *text, struct cli_size *out_size, struct error *out_error)
{
    unsigned width, height;
    char extra;
    if (sscanf(text, "%5ux%5u%c", &width, &height, &extra) != 2 || width < VIEW_MIN_EDGE ||
        width > VIEW_MAX_WIDTH || height < VIEW_MIN_EDGE || height > VIEW_MAX_HEIGHT)
        return error_set(out_error, "--size is \"%.200s\"; allowed: WxH from 1x1 to %ux%u", text,
                         VIEW_MAX_WIDTH, VIEW_MAX_HEIGHT);
    *out_size = (struct cli_size){width, height};
    return true;
}

static bool read_choice(const struct cli_option *option, const char *text, struct error *out_error)
{
    char allowed[ERROR_MESSAGE_SIZE] = "";
    size_t used = 0;
    for (uint32_t i = 0; i < option->name_count; i++) {
        if (strcmp(option->names[i], text) == 0) {
            *(uint32_t *)option->target = i;
            return true;
        }
        if (used < sizeof(allowed))
            used += (size_t)snprintf(allowed + used, sizeof(allowed) - used, "%s%s",
                                     i > 0 ? ", " : "", option->names[i]);
    }
    return error_set(out_error, "--%s is \"%.100s\"; allowed: %s", option->name, text, allowed);
}

static bool read_set(const char *text, struct cli_sets *sets, struct error *out_error)
{
    if (sets->count == CLI_MAX_SETS)
        return error_set(out_error, "--set is given more than %u times", CLI_MAX_SETS);
    if (!strchr(text, '='))
        return error_set(out_error, "--set is \"%.200s\"; KEY=VALUE is needed", text);
    sets->values[sets->count++] = text;
    return true;
}

static bool read_option(const struct cli_option *option, const char *text, struct error *out_error)
{
    double number = 0.0;
    switch (option->kind) {
    case CLI_OPTION_TEXT:
        *(const char **)option->target = text;
        return true;
    case CLI_OPTION_FLAG:
        *(bool *)option->target = true;
        return true;
    case CLI_OPTION_COUNT:
        if (!read_number(option, text, &number, out_error))
            return false;
        *(uint32_t *)option->target = (uint32_t)number;
        return true;
    case CLI_OPTION_NUMBER:
        return read_number(option, text, option->target, out_error);
    case CLI_OPTION_VECTOR:
        return read_vector(option, text, out_error);
    case CLI_OPTION_SIZE:
        return read_size(text, option->target, out_error);
    case CLI_OPTION_CHOICE:
        return read_choice(option, text, out_error);
    case CLI_OPTION_SETS:
        return read_set(text, option->target, out_error);
    }
    return false;
}

static bool take_argument(struct cli_parser *parser, const char *text, struct error *out_error)
{
    if (parser->argument_count == parser->max_arguments ||
        parser->argument_count == CLI_MAX_ARGUMENTS)
        return error_set(out_error, "unexpected argument \"%.200s\"", text);
    parser->arguments[parser->argument_count++] = text;
    return true;
}

// `out_help` if help was asked for.
static bool read_all(struct cli_parser *parser, int argc, char **argv, bool *out_help,
                     struct error *out_error)
{
    struct option names[CLI_MAX_OPTIONS + 2] = {{"help", no_argument, NULL, HELP_LETTER}};
    for (uint32_t i = 0; i < parser->option_count; i++)
        names[i + 1] = (struct option){
            parser->options[i].name,
            parser->options[i].kind == CLI_OPTION_FLAG ? no_argument : required_argument, NULL,
            FIRST_LETTER + (int)i};
    *out_help = false;
    opterr = 0;
    optind = 0; // starts over
    int letter;
    while ((letter = getopt_long(argc, argv, "", names, NULL)) != -1) {
        *out_help = letter == HELP_LETTER;
        if (*out_help)
            return true;
        if (letter < FIRST_LETTER)
            return error_set(out_error,
                             "unknown or incomplete option \"%.200s\"; see %s%s%s --help",
                             argv[optind - 1], program_invocation_short_name,
                             parser->command ? " " : "", parser->command ? parser->command : "");
        if (!read_option(&parser->options[letter - FIRST_LETTER], optarg, out_error))
            return false;
    }
    for (int i = optind; i < argc; i++)
        if (!take_argument(parser, argv[i], out_error))
            return false;
    return true;
}

static const struct cli_option *find_choice(const struct cli_parser *parser, const char *text)
{
    for (uint32_t i = 0; i < parser->option_count; i++) {
        const struct cli_option *option = &parser->options[i];
        if (option->kind == CLI_OPTION_CHOICE &&
            strncmp(text, option->name, strlen(option->name)) == 0)
            return option;
    }
    return NULL;
}

static void print_usage(const struct cli_parser *parser)
{
    for (const char *at = parser->usage; *at; at++) {
        const struct cli_option *option = *at == '@' ? find_choice(parser, at + 1) : NULL;
        if (!option) {
            putchar(*at);
            continue;
        }
        for (uint32_t i = 0; i < option->name_count; i++)
            printf("%s%s",
                   i == 0                        ? ""
                   : i + 1 == option->name_count ? " or "
                                                 : ", ",
                   option->names[i]);
        at += strlen(option->name);
    }
}

bool cli_parse(struct cli_parser *parser, int argc, char **argv, int *out_status)
{
    struct error error = {""};
    bool help;
    *out_status = 0;
    if (!read_all(parser, argc, argv, &help, &error))
        *out_status = cli_fail(CLI_EXIT_USAGE, "%s", error.message);
    else if (help)
        print_usage(parser);
    return *out_status == 0 && !help;
}

// The id of the scene's camera of this name or index.
static uint32_t find_camera(const struct scene *scene, const char *name)
{
    char *end;
    unsigned long index = strtoul(name, &end, 10);
    if (*name && !*end && index < scene->camera_count)
        return (uint32_t)index;
    for (uint32_t i = 0; i < scene->camera_count; i++)
        if (strcmp(scene->cameras[i].name, name) == 0)
            return i;
    return SCENE_NONE;
}

bool cli_camera_choose(const struct cli_camera *options, const struct scene *scene, float aspect,
                       struct view_camera *out_camera, struct error *out_error)
{
    if (options->eye.given != options->target.given)
        return error_set(out_error, "--eye and --target are needed together");
    if (options->name && options->eye.given)
        return error_set(out_error, "--camera and --eye exclude each other");
    shot_default_camera(scene, aspect, out_camera);
    if (options->eye.given) {
        static const float up[3] = {0.0f, 1.0f, 0.0f};
        memcpy(out_camera->eye, options->eye.xyz, sizeof(out_camera->eye));
        memcpy(out_camera->target, options->target.xyz, sizeof(out_camera->target));
        memcpy(out_camera->up, options->up.given ? options->up.xyz : up, sizeof(out_camera->up));
    }
    if (options->name) {
        uint32_t found = find_camera(scene, options->name);
        if (found == SCENE_NONE)
            return error_set(out_error, "there is no camera \"%.200s\"; the scene has %u cameras",
                             options->name, scene->camera_count);
        scene_get_camera_placement(scene, found, out_camera->eye, out_camera->target,
                                   out_camera->up);
        out_camera->fov_y_rad = scene->cameras[found].fov_y_rad;
    }
    if (options->fov_y_deg > 0.0)
        out_camera->fov_y_rad = (float)(options->fov_y_deg * M_PI / 180.0);
    return true;
}

bool cli_settings_apply(const struct cli_settings *options, enum quality preset,
                        struct scene *scene, struct render_settings *settings,
                        struct view_options *view, struct error *out_error)
{
    if (options->gi != CLI_NO_CHOICE)
        settings->gi_method = (enum gi_method)options->gi;
    if (options->view != CLI_NO_CHOICE)
        view->debug_view = (enum debug_view)options->view;
    view->quality = options->preset != CLI_NO_CHOICE ? (enum quality)options->preset : preset;
    for (uint32_t i = 0; i < options->sets.count; i++) {
        char key[256];
        const char *text = options->sets.values[i];
        const char *equals = strchr(text, '=');
        if ((size_t)(equals - text) >= sizeof(key))
            return error_set(out_error, "the key of --set \"%.200s\" is longer than %zu bytes",
                             text, sizeof(key) - 1);
        snprintf(key, sizeof(key), "%.*s", (int)(equals - text), text);
        if (!document_set_text(scene, settings, view, key, equals + 1, out_error))
            return false;
        if (view->rung[0])
            return error_set(out_error,
                             "--set \"%.200s\": configurations are measured by clients of the "
                             "daemon; see voxcast accuracy --help",
                             text);
    }
    return true;
}
