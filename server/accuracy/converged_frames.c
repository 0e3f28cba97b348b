// Waits for frames: a single one, the next of a moving camera, or as many as an image needs.
#include "server/accuracy/converged_frames.h"

#include <unistd.h>

// Pause between polls of a reference that is being traced.
#define PENDING_US 10000

bool frames_render_next(struct renderer *renderer, struct view *view,
                        const struct frame_params *params, struct frame_pixels *out_pixels,
                        struct error *out_error)
{
    enum render_result result = renderer_view_draw(renderer, view, params, out_error);
    if (result == RENDER_UNCHANGED) {
        renderer_view_invalidate(view);
        result = renderer_view_draw(renderer, view, params, out_error);
    }
    if (result != RENDER_DRAWN)
        return false;
    return renderer_view_collect(renderer, view, true, out_pixels) ||
           error_set(out_error, "the GPU did not finish the frame");
}

bool frames_render(struct renderer *renderer, struct view *view, const struct frame_params *params,
                   struct frame_pixels *out_pixels, struct error *out_error)
{
    renderer_view_invalidate(view);
    return frames_render_next(renderer, view, params, out_pixels, out_error);
}

// Draws one more frame and keeps its pixels instead of the last frame's.
static enum render_result render_one_more(struct converged_frames *render, struct error *out_error)
{
    enum render_result result =
        renderer_view_draw(render->renderer, render->view, render->params, out_error);
    while (result == RENDER_PENDING) {
        usleep(PENDING_US);
        result = renderer_view_draw(render->renderer, render->view, render->params, out_error);
    }
    if (result != RENDER_DRAWN)
        return result;
    if (render->frame_count > 0)
        renderer_view_release(render->renderer, render->view);
    render->frame_count++;
    if (!renderer_view_collect(render->renderer, render->view, true, &render->pixels)) {
        render->frame_count = 0; // no pixels are held
        error_set(out_error, "the GPU did not finish the frame");
        return RENDER_FAILED;
    }
    struct frame_statistics statistics;
    renderer_view_get_statistics(render->renderer, render->view, &statistics);
    if (render->measurement && !measurement_add(render->measurement, &statistics)) {
        error_set(out_error, "out of memory");
        return RENDER_FAILED;
    }
    return RENDER_DRAWN;
}

bool frames_render_converged(struct converged_frames *render, struct error *out_error)
{
    render->frame_count = 0;
    render->converged = false;
    renderer_view_invalidate(render->view);
    enum render_result result = RENDER_DRAWN;
    while (result == RENDER_DRAWN && render->frame_count < render->max_frames)
        result = render_one_more(render, out_error);
    render->converged = result == RENDER_UNCHANGED;
    if (result == RENDER_DRAWN || result == RENDER_UNCHANGED)
        return true;
    if (render->frame_count > 0)
        renderer_view_release(render->renderer, render->view);
    return false;
}
