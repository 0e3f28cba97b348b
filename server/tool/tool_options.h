// Options of the offline tool's commands: each is declared with the target of its value, and
// cli_parse() reads the command line into these places.
//
//     struct cli_parser parser = {.command = "bench", .usage = usage, .max_arguments = 1};
//     cli_take_count(&parser, "frames", 1, 100, &frames);
//     if (!cli_parse(&parser, argc, argv, &status))
//         return status;
#ifndef VOXCAST_SERVER_ACCURACY_TOOL_OPTIONS_H
#define VOXCAST_SERVER_ACCURACY_TOOL_OPTIONS_H

#include <stdbool.h>
#include <stdint.h>

#include "server/document/document.h"

#define CLI_MAX_OPTIONS   32u
#define CLI_MAX_SETS      256u
#define CLI_MAX_ARGUMENTS 256u
#define CLI_NO_CHOICE     UINT32_MAX

enum cli_option_kind {
    CLI_OPTION_TEXT,   // const char *
    CLI_OPTION_FLAG,   // bool; takes no value
    CLI_OPTION_COUNT,  // uint32_t
    CLI_OPTION_NUMBER, // double
    CLI_OPTION_VECTOR, // struct cli_vector
    CLI_OPTION_SIZE,   // struct cli_size
    CLI_OPTION_CHOICE, // uint32_t, the index of a name
    CLI_OPTION_SETS,   // struct cli_sets
};

struct cli_option {
    const char *name; // without "--"
    enum cli_option_kind kind;
    void *target;
    double low, high;         // allowed counts and numbers
    const char *const *names; // allowed choices
    uint32_t name_count;
};

struct cli_parser {
    const char *command; // as in "bench natus"; NULL for a program without commands
    const char *usage;   // what --help prints; "@gi" stands for what --gi may choose from
    uint32_t max_arguments;

    uint32_t option_count;
    struct cli_option options[CLI_MAX_OPTIONS];

    // Results: the arguments that are no options.
    uint32_t argument_count;
    const char *arguments[CLI_MAX_ARGUMENTS];
};

struct cli_vector {
    bool given;
    float xyz[3]; // finite
};

struct cli_size {
    uint32_t width, height; // in pixels, as views allow them
};

// KEY=VALUE of every --set.
struct cli_sets {
    uint32_t count;
    const char *values[CLI_MAX_SETS];
};

// --camera, --eye, --target, --up, --fov-y-deg.
struct cli_camera {
    const char *name; // or index; NULL if not given
    struct cli_vector eye, target, up;
    double fov_y_deg; // 0 if not given
};

// --gi, --preset, --view, --set; CLI_NO_CHOICE where not given.
struct cli_settings {
    uint32_t gi, preset, view;
    struct cli_sets sets;
};

// Targets keep their value if the option is not given. Texts point into argv.
void cli_take_text(struct cli_parser *parser, const char *name, const char **target);
void cli_take_flag(struct cli_parser *parser, const char *name, bool *target);
void cli_take_count(struct cli_parser *parser, const char *name, uint32_t low, uint32_t high,
                    uint32_t *target);
void cli_take_number(struct cli_parser *parser, const char *name, double low, double high,
                     double *target);
void cli_take_vector(struct cli_parser *parser, const char *name, struct cli_vector *target);
void cli_take_choice(struct cli_parser *parser, const char *name, const char *const *names,
                     uint32_t name_count, uint32_t *target);
void cli_take_size(struct cli_parser *parser, struct cli_size *target);
void cli_take_gpu(struct cli_parser *parser, const char **target); // "auto" if not given
void cli_take_preset(struct cli_parser *parser, uint32_t *target); // an enum quality
void cli_take_gi(struct cli_parser *parser, uint32_t *target);     // an enum gi_method
void cli_take_camera(struct cli_parser *parser, struct cli_camera *target);
void cli_take_settings(struct cli_parser *parser, struct cli_settings *target); // initialises it

// False when the command is to end with *out_status: after --help, which is printed, and after an
// error, which is reported on stderr with option, value and range.
bool cli_parse(struct cli_parser *parser, int argc, char **argv, int *out_status);

// The camera asked for, else shot_default_camera().
bool cli_camera_choose(const struct cli_camera *options, const struct scene *scene, float aspect,
                       struct view_camera *out_camera, struct error *out_error);

// Applies --gi, --preset (`preset` if not given), --view and every --set, in this order.
bool cli_settings_apply(const struct cli_settings *options, enum quality preset,
                        struct scene *scene, struct render_settings *settings,
                        struct view_options *view, struct error *out_error);

#endif
