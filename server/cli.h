// The offline tool's commands. Each returns the process's exit status: 0, or 1 to 99 after one line
// on stderr.
#ifndef VOXCAST_SERVER_CLI_H
#define VOXCAST_SERVER_CLI_H

#include <stdbool.h>
#include <stdint.h>

#include "renderer/renderer.h"

#define CLI_EXIT_USAGE  2
#define CLI_EXIT_SCENE  3
#define CLI_EXIT_RENDER 4
#define CLI_EXIT_OUTPUT 5

// No picture needs as many: a bound against one that never comes to rest.
#define CLI_MAX_CONVERGING_FRAMES 2000u

int cli_render(int argc, char **argv);
int cli_info(int argc, char **argv);
int cli_bench(int argc, char **argv);
int cli_shaders(int argc, char **argv);
int cli_compare(int argc, char **argv);
int cli_accuracy(int argc, char **argv);
int cli_stability(int argc, char **argv); // in tests/stability/, with its cases

// Prints one line to stderr and returns `status`.
int cli_fail(int status, const char *format, ...) __attribute__((format(printf, 2, 3)));

// Times of one thing over several frames.
struct cli_samples {
    uint32_t count;
    uint32_t capacity;
    double *values;
};

bool cli_samples_add(struct cli_samples *samples, double value);
void cli_samples_finish(struct cli_samples *samples);

// The value below which the share `quantile` of the samples lies (nearest rank); 0 without samples.
double cli_samples_quantile(const struct cli_samples *samples, double quantile);

// What was measured over the frames of one view.
struct cli_measurement {
    struct cli_samples frame_ms;
    struct cli_samples pass_ms[RENDERER_MAX_PASSES];
};

// Takes in the newest collected frame.
bool cli_measurement_add(struct cli_measurement *measurement,
                         const struct frame_statistics *statistics);
void cli_measurement_finish(struct cli_measurement *measurement);

// {"gl_renderer", "size", "frame_ms", "passes", "effects", "memory_bytes", "scene"} as the README
// describes; a cJSON object that the caller deletes. NULL when memory ends.
struct cJSON;
struct cJSON *cli_statistics_json(const struct cli_measurement *measurement,
                                  const struct frame_statistics *statistics,
                                  const struct renderer_info *info, const struct scene *scene,
                                  uint32_t width, uint32_t height);

// The view of a scene when none is asked for: its first camera, else one that frames its bounds
// from the front and a little above.
void cli_default_camera(const struct scene *scene, float aspect, struct view_camera *out_camera);

// Renders one frame of `params` anew and waits for it. On success the pixels must be released.
bool cli_render_frame(struct renderer *renderer, struct view *view,
                      const struct frame_params *params, struct frame_pixels *out_pixels,
                      struct error *out_error);

// The same for a camera that moves: what earlier frames have gathered stays in use.
bool cli_render_next_frame(struct renderer *renderer, struct view *view,
                           const struct frame_params *params, struct frame_pixels *out_pixels,
                           struct error *out_error);

// Frames of one picture, drawn until it has converged.
struct cli_converged_render {
    struct renderer *renderer;
    struct view *view;
    const struct frame_params *params;
    uint32_t max_frames;
    struct cli_measurement *measurement; // takes in each frame; NULL for none

    // Results.
    struct frame_pixels pixels; // of the newest frame
    uint32_t frame_count;
    bool converged; // else max_frames came first
};

// On success the pixels must be released.
bool cli_render_converged(struct cli_converged_render *render, struct error *out_error);

// Writes pixels by the file's extension: .pfm (FRAME_OUTPUT_LINEAR), .png or .jpg
// (FRAME_OUTPUT_RGBA8).
bool cli_write_picture(const char *path, const struct frame_pixels *pixels,
                       struct error *out_error);

// 3 bytes a pixel, row 0 at the top, to a .png.
bool cli_write_png(const char *path, uint32_t width, uint32_t height, const uint8_t *rgb,
                   struct error *out_error);

// Pixels of FRAME_OUTPUT_LINEAR as a picture of the caller's. False when out of memory.
bool cli_take_picture(const struct frame_pixels *pixels, struct picture *out_picture);

// Whether a name ends so, such as with ".png", in upper or lower case.
bool cli_has_extension(const char *path, const char *extension);

// The output that a file of this name wants; false if the extension is none of the three.
bool cli_output_of(const char *path, enum frame_output *out_output);

#endif
