// Which row of the quality table a view is drawn with: a cheap one while things move, the wanted
// one once they are still. Pure: times come from the caller.
#ifndef VOXCAST_SERVER_RENDER_QUALITY_CONTROLLER_H
#define VOXCAST_SERVER_RENDER_QUALITY_CONTROLLER_H

#include <stdbool.h>
#include <stdint.h>

#include "renderer/settings.h"

#define QUALITY_REST_US 200000u    // without a change for so long, an image is still
#define QUALITY_NEVER   UINT64_MAX // no moment at which to look again

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
    bool draft;               // moving images are drawn with the draft row
    uint32_t over_count;      // interactive frames in a row that took too long
    uint32_t under_count;     // draft frames in a row after which interactive ones would fit
    uint32_t draft_count;     // draft frames since the last drop, up to those that are learnt from
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

// When the choice will be another one if nothing changes, or QUALITY_NEVER.
uint64_t quality_controller_next_us(const struct quality_controller *controller,
                                    const struct quality_request *request, uint64_t now_us);

// Takes in a frame: its row, and how long it took. Frames of a moving image count that follow one
// of the same row: the first of a row resizes what it draws into. Three interactive ones in a row
// above the target change to draft. Back goes the way when eight draft ones in a row tell, by the
// ratio that the change showed, that interactive ones would take less than four fifths of the
// target: between the two bounds nothing changes, so that the row does not flap.
void quality_controller_take_frame(struct quality_controller *controller,
                                   const struct quality_request *request, enum quality row,
                                   bool moving, double frame_ms);

// The share of the way to the wanted image, from that of a frame of `row`: what is drawn with a
// lower row than the wanted one is never done.
float quality_convergence(enum quality row, enum quality wanted, float convergence);

#endif
