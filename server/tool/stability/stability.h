// The stability suite: cases that try to break the numbers. Each makes a scene in code, draws it
// through the library and measures how far an invariant is from holding.
//
// After every frame all floating-point resources are searched for values that are not finite, and
// one of them fails the case, as GL errors and frames that cannot be drawn do.
#ifndef VOXCAST_SERVER_TOOL_STABILITY_STABILITY_H
#define VOXCAST_SERVER_TOOL_STABILITY_STABILITY_H

#include "renderer/metrics/picture.h"
#include "renderer/renderer.h"

#define STABILITY_MAX_PICTURES 8u
#define STABILITY_WIDTH        80u
#define STABILITY_HEIGHT       60u

// Methods that a case is run with, as bits.
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
    double bound;           // what is measured must not be greater
    double voxel_bound;     // the same with voxels; 0: `bound`
    double reference_bound; // the same of the reference; 0: `bound`
    const char *unit;       // of bound and measured value
    // For a case that is known to miss its bound: what it must not exceed meanwhile; else 0.
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
    bool measured_any;   // else nothing was proved, which fails
    bool failed;         // whatever was measured
    char where[160];     // the worst was, or why it failed
    uint32_t frames;     // drawn
    uint64_t bad_values; // not finite, in all resources and frames
    uint64_t cut_values; // beyond half floats in voxels: the most of a view
    uint32_t picture_count;
    char pictures[STABILITY_MAX_PICTURES][96]; // files in the folder of results
    double seconds;
};

// What must not be exceeded with the run's method.
double stability_bound(const struct stability_run *run);

// Tells a value; the worst of a run counts. What is no number is infinitely bad.
void stability_measure(struct stability_run *run, double value, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

// Fails the run, whatever was measured.
void stability_fail(struct stability_run *run, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

// The suite's renderer. It is created at the first use, and again after stability_renew().
struct renderer *stability_renderer(struct stability_run *run);

// Ends the renderer, so that the next starts afresh, as with another environment.
void stability_renew(struct stability_run *run);

// Small, with coarse voxels, interactive quality, fixed exposure and linear output.
struct frame_params stability_params(const struct stability_run *run);

// A scene that is shown in a view, for cases that draw frame by frame. Owns view and image alone.
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

// Shows the scene in a view of its own until it has settled; a reference is traced without one. The
// caller finishes the image. False when the run has failed.
bool stability_draw(struct stability_run *run, struct scene *scene,
                    const struct frame_params *params, struct picture *out_picture);

// Writes an image as CASE-METHOD-NAME.png, as its own automatic exposure shows it (of black ones
// nothing), if results have a folder.
void stability_keep(struct stability_run *run, const struct picture *picture, const char *name);

// Mean LDR-FLIP between two images, both as the second's automatic exposure shows them.
double stability_flip(const struct picture *test, const struct picture *expected);

// Greatest difference of a channel, relative to the brightest of `truth`; `out_pixel` (or NULL) is
// where. Infinite where a value is not finite.
double stability_difference(const struct picture *test, const struct picture *expected,
                            uint32_t *out_pixel);

// Measures stability_difference() and keeps both images. `what` ("" for nothing) tells which of
// several comparisons it is.
void stability_compare(struct stability_run *run, const struct picture *test,
                       const struct picture *expected, const char *what);

// Channels that differ in any bit.
uint64_t stability_count_changed(const struct picture *a, const struct picture *b);

// Mean of the luminances.
double stability_mean(const struct picture *picture);

// Runs chosen cases; NULL chooses all.
struct stability_choice {
    const char *name;
    const char *family;
    const char *gpu;    // as renderer_params has it
    const char *folder; // for images and results.json; NULL for none
};

// Prints a table on stdout and writes results.json. `out_failures` counts failed runs. False with a
// message when no case is of that name, or results cannot be written.
bool stability_run_cases(const struct stability_choice *choice, uint32_t *out_failures,
                         struct error *out_error);

#endif
