// The stability suite: cases that try to break the numbers. Each makes a scene in code, draws it
// through the library and measures how far an invariant is from holding.
//
// After every frame all floating-point resources are searched for values that are not finite. One
// of them fails the case; so do GL errors and frames that cannot be drawn.
#ifndef VOXCAST_SERVER_TOOL_STABILITY_STABILITY_H
#define VOXCAST_SERVER_TOOL_STABILITY_STABILITY_H

#include "renderer/metrics/picture.h"
#include "renderer/renderer.h"

#define STABILITY_MAX_PICTURES 8u
#define STABILITY_WIDTH        80u
#define STABILITY_HEIGHT       60u

// Methods that a case runs with, as bits.
#define STABILITY_NONE      (1u << GI_METHOD_NONE)
#define STABILITY_CLIPMAP   (1u << GI_METHOD_CLIPMAP)
#define STABILITY_GRID      (1u << GI_METHOD_GRID)
#define STABILITY_REFERENCE (1u << GI_METHOD_REFERENCE)
#define STABILITY_VOXELS    (STABILITY_CLIPMAP | STABILITY_GRID)
#define STABILITY_DRAWN     (STABILITY_NONE | STABILITY_VOXELS)
#define STABILITY_ALL       (STABILITY_DRAWN | STABILITY_REFERENCE)

struct stability_run;

struct stability_case {
    const char *name;
    const char *invariant;  // in one line
    unsigned methods;       // STABILITY_ bits
    double bound;           // the measured value must not be greater
    double voxel_bound;     // the same with voxels; 0: `bound`
    double reference_bound; // the same with the reference; 0: `bound`
    const char *unit;       // of bound and measured value
    // For a case that is known to miss its bound: the value that it must not exceed until then;
    // else 0.
    double known;
    void (*run)(struct stability_run *run);
    int variant; // for cases that share a function
};

// The cases of a family, in a file of its own.
struct stability_table {
    const char *name;
    const char *title;
    const struct stability_case *cases;
    uint32_t count;
};
extern const struct stability_table *const stability_tables[];
extern const uint32_t stability_table_count;

// One case with one method.
struct stability_run {
    struct stability *suite;
    const struct stability_case *test;
    enum gi_method method;

    // Results.
    double measured;     // the worst
    bool measured_any;   // false: nothing was proved, which fails
    bool failed;         // whatever was measured
    char where[160];     // of the worst value, or why the run failed
    uint32_t frames;     // drawn
    uint64_t bad_values; // not finite, in all resources and frames
    uint64_t cut_values; // beyond half floats in voxels: the maximum over the views
    uint32_t picture_count;
    char pictures[STABILITY_MAX_PICTURES][96]; // files in the folder of results
    double seconds;
};

// The bound for the run's method.
double stability_bound(const struct stability_run *run);

// Reports a measured value; the worst of a run counts. NaN counts as infinite.
void stability_measure(struct stability_run *run, double value, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

// Fails the run, whatever was measured.
void stability_fail(struct stability_run *run, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

// The suite's renderer. It is created at the first use, and again after stability_renew().
struct renderer *stability_renderer(struct stability_run *run);

// Ends the renderer, so that the next use creates a new one, as after a change of environment
// variables.
void stability_renew(struct stability_run *run);

// Small image, coarse voxels, interactive quality, fixed exposure and linear output.
struct frame_params stability_params(const struct stability_run *run);

// A scene shown in a view, for cases that draw frame by frame. Owns view and image, not the scene.
struct stability_view {
    struct stability_run *run;
    struct view *view;
    struct picture picture; // the newest
};

// False when the run has failed.
bool stability_view_open(struct stability_view *view, struct stability_run *run,
                         struct scene *scene);
void stability_view_close(struct stability_view *view);

// Draws a frame and looks for values that are not finite. RENDER_UNCHANGED is no failure.
enum render_result stability_view_draw(struct stability_view *view,
                                       const struct frame_params *params);

// Draws until nothing changes any more. False when the run has failed.
bool stability_view_settle(struct stability_view *view, const struct frame_params *params);

// Shows the scene in a view of its own until the image has converged; a reference is traced without
// a view. The caller finishes the image. False when the run has failed.
bool stability_draw(struct stability_run *run, struct scene *scene,
                    const struct frame_params *params, struct picture *out_picture);

// Writes an image as CASE-METHOD-NAME.png with its own automatic exposure (a black one stays
// black), if results have a folder.
void stability_keep(struct stability_run *run, const struct picture *picture, const char *name);

// Mean LDR-FLIP between two images, both displayed with the second one's automatic exposure.
double stability_flip(const struct picture *test, const struct picture *expected);

// Greatest difference of a channel, relative to the brightest of `expected`; `out_pixel` (or NULL)
// receives its position. Infinite where a value is not finite.
double stability_difference(const struct picture *test, const struct picture *expected,
                            uint32_t *out_pixel);

// Measures stability_difference() and keeps both images. `what` ("" for none) names one of several
// comparisons.
void stability_compare(struct stability_run *run, const struct picture *test,
                       const struct picture *expected, const char *what);

// Counts the channels that differ in any bit.
uint64_t stability_count_changed(const struct picture *a, const struct picture *b);

// Mean luminance.
double stability_mean(const struct picture *picture);

// Runs chosen cases; NULL chooses all.
struct stability_choice {
    const char *name;
    const char *family;
    const char *gpu;    // as in struct renderer_params
    const char *folder; // for images and results.json; NULL for none
};

// Prints a table on stdout and writes results.json. `out_failures` counts failed runs. False with a
// message when no case has that name or results cannot be written.
bool stability_run_cases(const struct stability_choice *choice, uint32_t *out_failures,
                         struct error *out_error);

#endif
