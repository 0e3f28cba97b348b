// Ground truth: a progressive path tracer on the CPU, with the scene, materials, lights, units and
// camera of the real-time path: unbiased, but for caustics of points, where it is consistent (their
// blur shrinks with the samples). See path.h for what it holds light to do.
//
// A reference owns worker threads, which add samples to its picture while somebody wants them. The
// same seed gives the same picture, bit by bit, whatever the number of threads and however often
// work was stopped and taken up again, once a number of samples per pixel has been reached.
//
// All functions may be called from any thread, but only one at a time for each reference;
// reference_stop() alone may be called while another waits.
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

// How light is found: all estimators agree but for their noise. Points and directions can only be
// aimed at, whatever the estimator.
enum reference_estimator {
    REFERENCE_MIS,            // both ways, weighted
    REFERENCE_LIGHT_SAMPLING, // by aiming at lights
    REFERENCE_BSDF_SAMPLING,  // by following what surfaces scatter
};

// Pictures of light by how often it has been reflected; they sum up to all of it. What passes
// through a surface is not reflected.
enum reference_layer {
    REFERENCE_EMISSION,     // never: emission, background
    REFERENCE_DIRECT,       // once, of lights and emitters
    REFERENCE_SKY,          // once, of the environment
    REFERENCE_FIRST_BOUNCE, // twice; further layers follow, the last of which holds all the rest
    REFERENCE_MAX_LAYERS = REFERENCE_FIRST_BOUNCE + REFERENCE_MAX_BOUNCE_PICTURES
};

// Sets of layers, as bits.
#define REFERENCE_LAYER(layer)    (1u << (layer))
#define REFERENCE_ALL_LAYERS      UINT32_MAX
#define REFERENCE_DIRECT_LAYERS   (REFERENCE_LAYER(REFERENCE_FIRST_BOUNCE) - 1u)
#define REFERENCE_INDIRECT_LAYERS (~REFERENCE_DIRECT_LAYERS)

// An immutable copy of what light depends on in a scene, made by the thread that may edit that: the
// document may be edited as soon as snapshot_create() has returned. Counted: references of many
// cameras and threads share one.
struct scene;
struct snapshot;

// Copies the scene and builds its BVH; the caller holds one reference count.
// `all_blinn_phong` says that every material is to be Blinn-Phong (SHADING_MODEL_BLINN_PHONG).
// Cost: seconds for millions of triangles. NULL with a message when memory ends.
struct snapshot *snapshot_create(const struct scene *scene, bool all_blinn_phong,
                                 struct error *out_error);

// The same in two steps: a copy by the thread that may edit the scene, and the rest by any other,
// before the snapshot is used. Built in the background, that is by the calling thread alone, so
// that at low priority it takes nothing from others. False when memory ends.
struct snapshot *snapshot_copy(const struct scene *scene, bool all_blinn_phong,
                               struct error *out_error);
bool snapshot_build(struct snapshot *snapshot, bool in_background, struct error *out_error);

struct snapshot *snapshot_retain(struct snapshot *snapshot); // any thread
void snapshot_release(struct snapshot **snapshot);           // any thread; leaves NULL

struct reference_params {
    struct snapshot *scene; // the reference keeps a count of its own
    struct view_camera camera;
    uint32_t width, height;
    uint32_t max_bounces;     // of indirect light: light is reflected at most 1 + max_bounces times
    uint32_t bounce_pictures; // 1 to REFERENCE_MAX_BOUNCE_PICTURES; 0: one for all bounces
    uint64_t seed;
    enum reference_estimator estimator;
    uint32_t threads;  // 0: as many as there are processors
    bool low_priority; // workers give way to all others (nice 19)
    bool pixel_center; // rays through pixel centres; else all over the pixels (box filter)
};

struct reference;

// Starts workers, which sleep. NULL with a message when memory or threads run out.
struct reference *reference_create(const struct reference_params *params, struct error *out_error);

// Stops within milliseconds.
void reference_destroy(struct reference **reference);

// Lets the workers go on until every pixel has `samples` samples in all. Returns at once.
void reference_start(struct reference *reference, uint32_t samples);

// Waits until there are so many, work is stopped, or the time is over. True in the first case.
bool reference_wait(struct reference *reference, double seconds);

// Stops the workers within milliseconds and waits for that; what they were at in that time is lost.
void reference_stop(struct reference *reference);

// Adds samples and waits for them. False if stopped by another thread.
bool reference_render(struct reference *reference, uint32_t samples);

// Samples that every pixel has. Cheap.
uint32_t reference_get_samples(struct reference *reference);

struct reference_progress {
    uint32_t samples;      // every pixel has at least so many
    uint64_t nearest_rays; // cast so far: along paths,
    uint64_t shadow_rays;  // and towards lights
    double noise;          // estimated standard error of a pixel's luminance (root mean square
                           // over the picture), over the mean luminance; INFINITY before 2 samples
    double mean_luminance; // cd/m^2
};

// Cost: one pass over the picture.
void reference_get_progress(struct reference *reference, struct reference_progress *out_progress);

uint32_t reference_layer_count(const struct reference_params *params);

// The sum of a set of layers so far: linear Rec.709 radiance in cd/m^2, width x height x 4 floats
// (the last is 1), row 0 at the top. Black where a pixel has no sample yet.
void reference_get_picture(struct reference *reference, uint32_t layers, float *out_rgba);

#endif
