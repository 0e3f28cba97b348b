// The reference: a progressive CPU path tracer with the scene, materials, lights, units and camera
// of the real-time renderer. Unbiased, except for caustics of point lights, where it is consistent
// (their blur shrinks with the samples). See path.h for its light transport.
//
// A reference owns worker threads, which add samples on request. At a given number of samples per
// pixel the same seed gives the same image, bit by bit, for any number of threads and any
// interruptions.
//
// Functions may be called from any thread, but only one at a time per reference; only
// reference_stop() may be called while another waits.
#ifndef VOXCAST_RENDERER_PATH_TRACER_REFERENCE_H
#define VOXCAST_RENDERER_PATH_TRACER_REFERENCE_H

#include <stdbool.h>
#include <stdint.h>

#include "renderer/error.h"
#include "renderer/settings.h"

#define REFERENCE_UNLIMITED           UINT32_MAX
#define REFERENCE_MAX_BOUNCE_PICTURES 8u
#define REFERENCE_MAX_THREADS         256u
#define REFERENCE_MAX_SAMPLES         (1u << 30)

// How light is sampled: all estimators agree except for noise. Point and directional lights are
// always sampled directly.
enum reference_estimator {
    REFERENCE_MIS,            // both, weighted
    REFERENCE_LIGHT_SAMPLING, // light sampling only
    REFERENCE_BSDF_SAMPLING,  // BSDF sampling only
};

// Images of light by number of reflections; their sum is all light. Passing through a surface does
// not count as reflection.
enum reference_layer {
    REFERENCE_EMISSION,     // none: emission, background
    REFERENCE_DIRECT,       // one, from lights and emitters
    REFERENCE_SKY,          // one, from the environment
    REFERENCE_FIRST_BOUNCE, // two; more layers follow, the last of which holds the rest
    REFERENCE_MAX_LAYERS = REFERENCE_FIRST_BOUNCE + REFERENCE_MAX_BOUNCE_PICTURES
};

// Sets of layers, as bits.
#define REFERENCE_LAYER(layer)    (1u << (layer))
#define REFERENCE_ALL_LAYERS      UINT32_MAX
#define REFERENCE_DIRECT_LAYERS   (REFERENCE_LAYER(REFERENCE_FIRST_BOUNCE) - 1u)
#define REFERENCE_INDIRECT_LAYERS (~REFERENCE_DIRECT_LAYERS)

// Immutable copy of what light depends on in a scene. Create it on the thread that may edit the
// scene, which may be edited once snapshot_create() has returned. Reference counted: references of
// many cameras and threads share it.
struct scene;
struct snapshot;

// Copies the scene and builds its BVH; the caller gets one count. `all_blinn_phong`: shade every
// material as Blinn-Phong (SHADING_MODEL_BLINN_PHONG). Cost: seconds for millions of triangles.
// NULL with a message when memory runs out.
struct snapshot *snapshot_create(const struct scene *scene, bool all_blinn_phong,
                                 struct error *out_error);

// The same in two steps: a copy on the thread that may edit the scene; then the rest on any thread,
// before the snapshot is used. In the background it is built by the calling thread alone, so at low
// priority it takes no time from others. False when memory runs out.
struct snapshot *snapshot_copy(const struct scene *scene, bool all_blinn_phong,
                               struct error *out_error);
bool snapshot_build(struct snapshot *snapshot, bool in_background, struct error *out_error);

struct snapshot *snapshot_retain(struct snapshot *snapshot); // any thread
void snapshot_release(struct snapshot **snapshot);           // any thread; leaves NULL

struct reference_params {
    struct snapshot *scene; // the reference takes a count of its own
    struct view_camera camera;
    uint32_t width, height;
    uint32_t max_bounces;     // of indirect light: at most 1 + max_bounces reflections
    uint32_t bounce_pictures; // 1 to REFERENCE_MAX_BOUNCE_PICTURES; 0: one for all bounces
    uint64_t seed;
    enum reference_estimator estimator;
    uint32_t threads;  // 0: number of processors
    bool low_priority; // workers run at nice 19
    bool pixel_center; // rays through pixel centres; else over the whole pixel (box filter)
};

struct reference;

// Creates workers, which sleep. NULL with a message when memory or threads run out.
struct reference *reference_create(const struct reference_params *params, struct error *out_error);

// Stops within milliseconds.
void reference_destroy(struct reference **reference);

// Lets the workers run until every pixel has `samples` samples in total. Returns at once.
void reference_start(struct reference *reference, uint32_t samples);

// Waits until that is reached, work is stopped, or the time is up. True in the first case.
bool reference_wait(struct reference *reference, double seconds);

// Stops the workers within milliseconds and waits for them; unfinished tiles are discarded.
void reference_stop(struct reference *reference);

// Adds samples and waits for them. False if stopped by another thread.
bool reference_render(struct reference *reference, uint32_t samples);

// Minimum samples over all pixels. Cheap.
uint32_t reference_get_samples(struct reference *reference);

struct reference_progress {
    uint32_t samples;      // minimum per pixel
    uint64_t nearest_rays; // so far: along paths,
    uint64_t shadow_rays;  // and to lights
    double noise; // estimated standard error of a pixel's luminance (root mean square over the
                  // image), over the mean luminance; INFINITY before 2 samples
    double mean_luminance; // cd/m^2
};

// Cost: one pass over the image.
void reference_get_progress(struct reference *reference, struct reference_progress *out_progress);

uint32_t reference_layer_count(const struct reference_params *params);

// Sum of a set of layers so far: linear Rec.709 radiance in cd/m^2, width x height x 4 floats (the
// last is 1), row 0 at the top. Black where a pixel has no sample yet.
void reference_get_picture(struct reference *reference, uint32_t layers, float *out_rgba);

#endif
