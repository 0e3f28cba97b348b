// The reference of one view, for a scene that is being edited: waits until camera and scene stop
// changing, takes a snapshot, and traces it on idle processors.
//
// Render thread only.
#ifndef VOXCAST_RENDERER_PATH_TRACER_PROGRESSIVE_H
#define VOXCAST_RENDERER_PATH_TRACER_PROGRESSIVE_H

#include <pthread.h>

#include "renderer/path_tracer/reference.h"
#include "renderer/scene/scene.h"

// Snapshot of a scene, shared by its views; at most one at a time. Built on a thread of its own at
// lowest priority. Zero-initialised: none.
struct live_scene {
    struct snapshot *snapshot; // NULL for none; under construction while `builds`
    uint64_t scene_number;
    struct scene_revisions revisions;
    bool all_blinn_phong;
    bool builds;
    pthread_t builder;
    int built; // set by the builder, atomically: 1 done, -1 failed
};

// Waits for the builder, if any.
void live_scene_finish(struct live_scene *scene);

// Whether live_scene_finish() would wait.
bool live_scene_is_building(const struct live_scene *scene);

// What a view shows.
struct live_params {
    const struct scene *scene;
    uint64_t scene_number; // tells apart scenes that were set one after another
    struct view_camera camera;
    uint32_t width, height;
    uint32_t max_bounces;
    bool all_blinn_phong;
    bool direct_only; // at most one reflection
};

struct live_reference {
    struct reference *reference; // NULL until camera and scene stop changing
    struct live_params params;   // newest
    struct scene_revisions revisions;
    double changed_at_ms; // time of the last change
    double shown_at_ms;
    uint32_t shown_samples; // of the newest image; 0: none
    struct reference_progress progress;
    float *rgba;    // newest image
    bool converged; // enough samples
};

void live_reference_finish(struct live_reference *live);

// Whether live_reference_update() has been called since.
bool live_reference_is_used(const struct live_reference *live);

enum live_state {
    LIVE_WAITING,  // nothing to show yet
    LIVE_SAME,     // nothing better than what was shown last
    LIVE_NEW,      // a new image is in live->rgba
    LIVE_FINISHED, // no better image will come
};

// Restarts after a change, and fetches the newest image when due. A failure sets the message and
// returns LIVE_WAITING.
enum live_state live_reference_update(struct live_reference *live, struct live_scene *scene,
                                      const struct live_params *params, struct error *out_error);

// 0 to 1: progress towards the wanted noise.
float live_reference_convergence(const struct live_reference *live);

#endif
