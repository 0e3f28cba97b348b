// Shared by the tests of the frame plan: a situation that a frame is planned in, and what changes
// it.
#ifndef VOXCAST_TESTS_UNIT_SUPPORT_FRAME_H
#define VOXCAST_TESTS_UNIT_SUPPORT_FRAME_H

#include "renderer/frame/frame_plan.h"

#define WIDTH  64u
#define HEIGHT 40u

// A view at rest in a lit scene with a converged volume: the frame before was the same.
struct situation {
    struct frame_params params;
    struct scene_revisions revisions;
    struct frame_history history;
    struct gi_state gi;
    struct frame_inputs inputs;
};

void at_rest(struct situation *it);

// Changes since the frame before.
void camera_moves(struct situation *it);
void size_changes(struct situation *it);
void quality_changes(struct situation *it);
void geometry_changes(struct situation *it);
void transform_changes(struct situation *it);
void material_changes(struct situation *it);
void light_changes(struct situation *it);
void environment_changes(struct situation *it);
void debug_view_changes(struct situation *it);
void tonemap_changes(struct situation *it);
void bounces_change(struct situation *it);

// The frames before have accumulated samples: a few, or all.
void samples_are_few(struct situation *it);
void all_samples_are_in(struct situation *it);

#endif
