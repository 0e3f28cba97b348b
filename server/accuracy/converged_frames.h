// Waits for frames: a single one, the next of a moving camera, or as many as an image needs.
#ifndef VOXCAST_SERVER_ACCURACY_CONVERGED_FRAMES_H
#define VOXCAST_SERVER_ACCURACY_CONVERGED_FRAMES_H

#include "renderer/renderer.h"
#include "server/accuracy/measurement.h"

// More than any image needs: a bound, in case one never converges.
#define MAX_CONVERGING_FRAMES 2000u

// Renders one frame of `params` from scratch and waits for it. On success the caller must release
// the pixels.
bool frames_render(struct renderer *renderer, struct view *view, const struct frame_params *params,
                   struct frame_pixels *out_pixels, struct error *out_error);

// The same for a moving camera: cached light of earlier frames stays in use.
bool frames_render_next(struct renderer *renderer, struct view *view,
                        const struct frame_params *params, struct frame_pixels *out_pixels,
                        struct error *out_error);

// Frames of one image, drawn until it has converged.
struct converged_frames {
    struct renderer *renderer;
    struct view *view;
    const struct frame_params *params;
    uint32_t max_frames;
    struct measurement *measurement; // receives each frame; NULL for none

    // Results.
    struct frame_pixels pixels; // of the newest frame
    uint32_t frame_count;
    bool converged; // false: max_frames was reached first
};

// On success the caller must release the pixels.
bool frames_render_converged(struct converged_frames *render, struct error *out_error);

#endif
