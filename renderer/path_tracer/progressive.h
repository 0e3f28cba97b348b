// The reference of one view, kept in step with a document that is being edited: it waits until
// camera and scene rest, takes a snapshot, and has idle processors trace it.
//
// Runs on the render thread.
#ifndef VOXCAST_RENDERER_PATH_TRACER_PROGRESSIVE_H
#define VOXCAST_RENDERER_PATH_TRACER_PROGRESSIVE_H

#include <pthread.h>

#include "renderer/path_tracer/reference.h"
#include "renderer/scene/scene.h"

// Snapshots of a document, shared by its views; at most one at a time. They are built by a thread
// of their own at lowest priority. Zero means none.
struct live_scene {
    struct snapshot *snapshot; // NULL for none; being built while `builds`
    uint64_t scene_number;
    struct scene_revisions revisions;
    bool all_blinn_phong;
    bool builds;
    pthread_t builder;
    int built; // set by the builder, atomically: 1 done, -1 failed
};

// Waits for the builder, if there is one.
void live_scene_finish(struct live_scene *scene);

// What a view wants to see.
struct live_params {
    const struct scene *scene;
    uint64_t scene_number; // tells scenes apart that are loaded one after another
    struct view_camera camera;
    uint32_t width, height;
    uint32_t max_bounces;
    bool all_blinn_phong;
    bool direct_only; // shows light that has been reflected once at most
};

struct live_reference {
    struct reference *reference; // NULL until something rests
    struct live_params params;   // newest
    struct scene_revisions revisions;
    double changed_at_ms; // since when nothing has changed
    double shown_at_ms;
    uint32_t shown_samples; // of the newest picture; 0: none
    struct reference_progress progress;
    float *rgba;    // the newest picture
    bool converged; // no more samples are wanted
};

void live_reference_finish(struct live_reference *live);

enum live_state {
    LIVE_WAITING,  // nothing to show yet
    LIVE_SAME,     // nothing better than what was shown last
    LIVE_NEW,      // a new picture is in live->rgba
    LIVE_FINISHED, // no better picture will come
};

// Starts anew if anything has changed, and fetches the newest picture if it is due. A failure is
// told as a message and looks like waiting.
enum live_state live_reference_update(struct live_reference *live, struct live_scene *scene,
                                      const struct live_params *params, struct error *out_error);

// 0 to 1: how much of what is wanted has been traced.
float live_reference_convergence(const struct live_reference *live);

#endif
