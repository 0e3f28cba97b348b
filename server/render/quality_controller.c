#include "server/render/quality_controller.h"

#include <math.h>

#define FRAMES_TO_DROP     3u
#define FRAMES_TO_CLIMB    8u
#define FRAMES_TO_LEARN    3u
#define CLIMB_FRACTION     0.8  // of the target
#define MIN_RATIO          1.25 // so that a drop that gained little is not undone at once
#define LOWER_ROW_FRACTION 0.5f // the highest convergence of a lower row

void quality_controller_move(struct quality_controller *controller, uint64_t now_us)
{
    controller->moved_at_us = now_us;
}

bool quality_controller_is_moving(const struct quality_controller *controller, uint64_t now_us)
{
    return controller->moved_at_us > 0 && now_us < controller->moved_at_us + QUALITY_REST_US;
}

static enum quality lower(enum quality a, enum quality b)
{
    return a < b ? a : b;
}

enum quality quality_controller_choose(const struct quality_controller *controller,
                                       const struct quality_request *request, uint64_t now_us)
{
    if (!request->adaptive || !quality_controller_is_moving(controller, now_us))
        return request->wanted;
    return lower(controller->draft ? QUALITY_DRAFT : QUALITY_INTERACTIVE, request->wanted);
}

uint64_t quality_controller_next_us(const struct quality_controller *controller,
                                    const struct quality_request *request, uint64_t now_us)
{
    if (quality_controller_choose(controller, request, now_us) == request->wanted)
        return QUALITY_NEVER;
    return controller->moved_at_us + QUALITY_REST_US;
}

// The shortest time counts: longer ones may hold compiling of shaders or allocations.
static void take_interactive(struct quality_controller *controller, double target_ms,
                             double frame_ms)
{
    if (frame_ms <= target_ms) {
        controller->over_count = 0;
        return;
    }
    if (controller->over_count == 0 || frame_ms < controller->interactive_ms)
        controller->interactive_ms = frame_ms;
    controller->over_count++;
    if (controller->over_count < FRAMES_TO_DROP)
        return;
    controller->draft = true;
    controller->over_count = 0;
    controller->under_count = 0;
    controller->draft_count = 0;
}

static void take_draft(struct quality_controller *controller, double target_ms, double frame_ms)
{
    if (controller->draft_count < FRAMES_TO_LEARN) {
        if (controller->draft_count == 0 || frame_ms < controller->draft_ms)
            controller->draft_ms = frame_ms;
        controller->draft_count++;
        controller->interactive_ratio =
            fmax(controller->interactive_ms / fmax(controller->draft_ms, 1e-3), MIN_RATIO);
        return;
    }
    bool would_fit = frame_ms * controller->interactive_ratio < CLIMB_FRACTION * target_ms;
    controller->under_count = would_fit ? controller->under_count + 1 : 0;
    if (controller->under_count >= FRAMES_TO_CLIMB)
        controller->draft = false;
}

void quality_controller_take_frame(struct quality_controller *controller,
                                   const struct quality_request *request, enum quality row,
                                   bool moving, double frame_ms)
{
    bool changed = row != controller->last_row;
    controller->last_row = row;
    if (!request->adaptive || !moving || changed)
        return;
    if (row == QUALITY_INTERACTIVE && !controller->draft)
        take_interactive(controller, request->target_frame_ms, frame_ms);
    else if (row == QUALITY_DRAFT && controller->draft)
        take_draft(controller, request->target_frame_ms, frame_ms);
}

float quality_convergence(enum quality row, enum quality wanted, float convergence)
{
    return row < wanted ? LOWER_ROW_FRACTION * convergence : convergence;
}
