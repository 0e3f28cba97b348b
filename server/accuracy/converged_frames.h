// Frames that are waited for: one, the next of a moving camera, or as many as an image needs.
#ifndef VOXCAST_SERVER_ACCURACY_CONVERGED_FRAMES_H
#define VOXCAST_SERVER_ACCURACY_CONVERGED_FRAMES_H

#include "renderer/renderer.h"
#include "server/accuracy/measurement.h"

// No image needs as many: a bound against one that never comes to rest.
#define MAX_CONVERGING_FRAMES 2000u

// Renders one frame of `params` anew and waits for it. On success the pixels must be released.
bool frames_render(struct renderer *renderer, struct view *view, const struct frame_params *params,
                   struct frame_pixels *out_pixels, struct error *out_error);

// The same for a camera that moves: what earlier frames have gathered stays in use.
bool frames_render_next(struct renderer *renderer, struct view *view,
                        const struct frame_params *params, struct frame_pixels *out_pixels,
                        struct error *out_error);

// Frames of one image, drawn until it has converged.
struct converged_frames {
    struct renderer *renderer;
    struct view *view;
    const struct frame_params *params;
    uint32_t max_frames;
    struct measurement *measurement; // takes in each frame; NULL for none

    // Results.
    struct frame_pixels pixels; // of the newest frame
    uint32_t frame_count;
    bool converged; // else max_frames came first
};

// On success the pixels must be released.
bool frames_render_converged(struct converged_frames *render, struct error *out_error);

#endif
