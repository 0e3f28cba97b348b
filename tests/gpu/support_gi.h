// Shared by the tests of global illumination: images drawn until they have converged, their means,
// and a report that prints every measured figure and fails at the end.
#ifndef VOXCAST_TESTS_GPU_SUPPORT_GI_H
#define VOXCAST_TESTS_GPU_SUPPORT_GI_H

#include "support_gpu.h"
#include "support_path.h"

// Methods to prove, in the order of `enum gi_method` without `none`.
#define GI_PROVED_METHODS 2u
extern const enum gi_method gi_proved_methods[GI_PROVED_METHODS];

// Whether VOXCAST_TEST_FULL is set: run every combination, not a selection.
bool gi_test_is_full(void);

// Prints one line, "ok" or "BAD" and the text, and counts failures.
struct gi_report {
    uint32_t checked;
    uint32_t bad;
};
void gi_check(struct gi_report *report, bool good, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

// Checks |measured / expected - 1| <= tolerance.
void gi_check_ratio(struct gi_report *report, double measured, double expected, double tolerance,
                    const char *format, ...) __attribute__((format(printf, 5, 6)));

// Fails the test if anything was bad or nothing was checked.
void gi_report_finish(const struct gi_report *report);

// Draws one frame of a scene that is shown; prints the reason on failure. Allocates the image if
// needed.
enum render_result gi_draw_once(struct renderer *renderer, struct view *view,
                                const struct frame_params *params,
                                struct test_picture *out_picture);

// Draws with the same parameters until RENDER_UNCHANGED, at most GI_MAX_FRAMES times. Beyond that
// it says so, and gi_report_finish() fails. Returns the number of frames; 0, with the reason
// printed, if one cannot be drawn. The scene must have been shown by renderer_set_scene().
#define GI_MAX_FRAMES 512u
uint32_t gi_converge(struct renderer *renderer, struct view *view,
                     const struct frame_params *params, struct test_picture *out_picture);

// Shows the scene, draws it in a view of its own until it has converged, and hides it again. Prints
// the number of frames unless it was one. The image holds floats for FRAME_OUTPUT_LINEAR, and bytes
// as floats 0..255 for RGBA8. Fails the test if the scene cannot be drawn.
struct test_picture gi_draw(struct scene *scene, const struct frame_params *params);

// The same in two steps, so that several images of one scene share its voxels: a view of a scene
// between gi_show() and gi_hide().
struct view *gi_show(struct scene *scene);
struct test_picture gi_draw_in(struct view *view, const struct frame_params *params);
void gi_hide(struct view **view);

void gi_picture_finish(struct test_picture *picture);

// Mean of red, green and blue.
void gi_mean(const float *pixels, uint32_t width, uint32_t height, double out_rgb[3]);

// A quantile of the red values: 0 the smallest, 0.5 the median, 1 the largest.
double gi_quantile(const struct test_picture *picture, double fraction);

// As test_params(), for a method: linear output, direct light as the path tracer has it.
struct frame_params gi_params(uint32_t width, uint32_t height, enum gi_method method);

#endif
