// Which row of the quality table a view is drawn with: a cheap one while things move, the wanted
// one once they rest. Pure: times come from the caller.
#ifndef VOXCAST_SERVER_RENDER_QUALITY_CONTROLLER_H
#define VOXCAST_SERVER_RENDER_QUALITY_CONTROLLER_H

#include <stdbool.h>
#include <stdint.h>

#include "renderer/settings.h"

#define QUALITY_REST_US 200000u    // after this time without a change, a view is at rest
#define QUALITY_NEVER   UINT64_MAX // the choice will not change by itself

// What a view's user asks for.
struct quality_request {
    enum quality wanted;
    bool adaptive; // else always the wanted row
    uint32_t target_frame_ms;
};

// One view's state; all 0 is a view that has never changed.
struct quality_controller {
    uint64_t moved_at_us;
    enum quality last_row;    // of the newest frame
    bool draft;               // frames in motion use the draft row
    uint32_t over_count;      // interactive frames in a row that took too long
    uint32_t under_count;     // draft frames in a row after which interactive ones would fit
    uint32_t draft_count;     // draft frames since the last drop, at most FRAMES_TO_LEARN
    double interactive_ms;    // of the frames that led to the last drop
    double draft_ms;          // of the first frames after it
    double interactive_ratio; // from these two: interactive over draft
};

// The camera or the document has changed.
void quality_controller_move(struct quality_controller *controller, uint64_t now_us);

bool quality_controller_is_moving(const struct quality_controller *controller, uint64_t now_us);

// The row to draw with now.
enum quality quality_controller_choose(const struct quality_controller *controller,
                                       const struct quality_request *request, uint64_t now_us);

// When the choice will change if nothing happens, or QUALITY_NEVER.
uint64_t quality_controller_next_us(const struct quality_controller *controller,
                                    const struct quality_request *request, uint64_t now_us);

// Takes in a frame: its row, and how long it took. Frames in motion count that follow one of the
// same row: the first frame of a row reallocates its targets. Three interactive frames in a row
// above the target change to draft. Eight draft frames in a row change back if, by the ratio that
// the drop showed, interactive ones would take less than four fifths of the target. Between the two
// bounds nothing changes, so that the row does not flap.
void quality_controller_take_frame(struct quality_controller *controller,
                                   const struct quality_request *request, enum quality row,
                                   bool moving, double frame_ms);

// Convergence towards the wanted image, for a frame of `row` with a convergence of its own: an
// image drawn with a lower row than the wanted one never counts as converged.
float quality_convergence(enum quality row, enum quality wanted, float convergence);

#endif
