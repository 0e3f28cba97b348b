// Proves which row of the quality table a view gets: a low one while it moves, the wanted one at
// rest, draft only where frames take too long, and no flapping between the two.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "server/render/quality_controller.h"

#define START_US 1000000u

static const struct quality_request final_request = {QUALITY_FINAL, true, 100};

static void take(struct quality_controller *controller, enum quality row, double ms, int count)
{
    for (int i = 0; i < count; i++)
        quality_controller_take_frame(controller, &final_request, row, true, ms);
}

static enum quality moving_row(const struct quality_controller *controller,
                               const struct quality_request *request)
{
    return quality_controller_choose(controller, request, controller->moved_at_us);
}

static void stillness_brings_the_wanted_row(void **state)
{
    (void)state;
    struct quality_controller controller = {0};
    const struct quality_request *request = &final_request;
    assert_int_equal(quality_controller_choose(&controller, request, START_US), QUALITY_FINAL);
    assert_true(quality_controller_next_us(&controller, request, START_US) == QUALITY_NEVER);
    quality_controller_move(&controller, START_US);
    uint64_t rest_us = START_US + QUALITY_REST_US;
    assert_int_equal(quality_controller_choose(&controller, request, START_US),
                     QUALITY_INTERACTIVE);
    assert_int_equal(quality_controller_choose(&controller, request, rest_us - 1),
                     QUALITY_INTERACTIVE);
    assert_true(quality_controller_next_us(&controller, request, START_US) == rest_us);
    assert_int_equal(quality_controller_choose(&controller, request, rest_us), QUALITY_FINAL);
    assert_true(quality_controller_next_us(&controller, request, rest_us) == QUALITY_NEVER);
    quality_controller_move(&controller, rest_us + 5);
    assert_int_equal(quality_controller_choose(&controller, request, rest_us + 6),
                     QUALITY_INTERACTIVE);
}

static void a_wanted_row_is_never_exceeded(void **state)
{
    (void)state;
    struct quality_controller controller = {0};
    quality_controller_move(&controller, START_US);
    const struct quality_request draft = {QUALITY_DRAFT, true, 100};
    assert_int_equal(moving_row(&controller, &draft), QUALITY_DRAFT);
    assert_true(quality_controller_next_us(&controller, &draft, START_US) == QUALITY_NEVER);
    const struct quality_request interactive = {QUALITY_INTERACTIVE, true, 100};
    assert_int_equal(moving_row(&controller, &interactive), QUALITY_INTERACTIVE);
    take(&controller, QUALITY_INTERACTIVE, 500.0, 4);
    assert_int_equal(moving_row(&controller, &interactive), QUALITY_DRAFT);
    assert_int_equal(
        quality_controller_choose(&controller, &interactive, START_US + QUALITY_REST_US),
        QUALITY_INTERACTIVE);
}

static void without_adaption_the_row_is_fixed(void **state)
{
    (void)state;
    struct quality_controller controller = {0};
    const struct quality_request fixed = {QUALITY_FINAL, false, 100};
    quality_controller_move(&controller, START_US);
    assert_int_equal(moving_row(&controller, &fixed), QUALITY_FINAL);
    for (int i = 0; i < 20; i++)
        quality_controller_take_frame(&controller, &fixed, QUALITY_INTERACTIVE, true, 900.0);
    assert_int_equal(moving_row(&controller, &final_request), QUALITY_INTERACTIVE);
}

static void slow_frames_lead_to_draft_and_fast_ones_back(void **state)
{
    (void)state;
    struct quality_controller controller = {0};
    quality_controller_move(&controller, START_US);
    take(&controller, QUALITY_INTERACTIVE, 900.0, 2); // as when shaders compile
    take(&controller, QUALITY_INTERACTIVE, 60.0, 1);
    take(&controller, QUALITY_INTERACTIVE, 150.0, 2);
    assert_int_equal(moving_row(&controller, &final_request), QUALITY_INTERACTIVE);
    take(&controller, QUALITY_INTERACTIVE, 150.0, 1);
    assert_int_equal(moving_row(&controller, &final_request), QUALITY_DRAFT);
    // 150 ms became 50 ms: three to one. Interactive frames would still take 90 ms.
    take(&controller, QUALITY_DRAFT, 200.0, 1);
    take(&controller, QUALITY_DRAFT, 50.0, 3);
    take(&controller, QUALITY_DRAFT, 30.0, 100);
    assert_int_equal(moving_row(&controller, &final_request), QUALITY_DRAFT);
    take(&controller, QUALITY_DRAFT, 25.0, 7);
    assert_int_equal(moving_row(&controller, &final_request), QUALITY_DRAFT);
    take(&controller, QUALITY_DRAFT, 25.0, 1);
    assert_int_equal(moving_row(&controller, &final_request), QUALITY_INTERACTIVE);
}

static void single_steps_and_frames_at_rest_do_not_count(void **state)
{
    (void)state;
    struct quality_controller controller = {0};
    quality_controller_move(&controller, START_US);
    for (int i = 0; i < 20; i++) {
        take(&controller, QUALITY_INTERACTIVE, 500.0, 1);
        take(&controller, QUALITY_FINAL, 900.0, 1);
    }
    for (int i = 0; i < 20; i++)
        quality_controller_take_frame(&controller, &final_request, QUALITY_INTERACTIVE, false,
                                      500.0);
    assert_int_equal(moving_row(&controller, &final_request), QUALITY_INTERACTIVE);
}

// Frames as a steady scene would give them, by the row that was chosen.
static void steady_scenes_do_not_flap(void **state)
{
    (void)state;
    const double times_ms[][2] = {{20, 90}, {20, 101}, {30, 110}, {60, 120}, {99, 100.5}, {5, 400}};
    for (size_t i = 0; i < sizeof(times_ms) / sizeof(times_ms[0]); i++) {
        struct quality_controller controller = {0};
        quality_controller_move(&controller, START_US);
        int changes = 0;
        enum quality last = moving_row(&controller, &final_request);
        for (int frame = 0; frame < 1000; frame++) {
            enum quality row = moving_row(&controller, &final_request);
            changes += row != last;
            last = row;
            double jitter = frame % 2 ? 1.04 : 0.96;
            take(&controller, row, jitter * times_ms[i][row == QUALITY_INTERACTIVE], 1);
        }
        assert_true(changes <= 1);
    }
}

static void lower_rows_are_not_done(void **state)
{
    (void)state;
    assert_true(quality_convergence(QUALITY_INTERACTIVE, QUALITY_FINAL, 1.0f) < 1.0f);
    assert_true(quality_convergence(QUALITY_FINAL, QUALITY_FINAL, 1.0f) == 1.0f);
    assert_true(quality_convergence(QUALITY_HIGH, QUALITY_HIGH, 0.25f) == 0.25f);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(stillness_brings_the_wanted_row),
        cmocka_unit_test(a_wanted_row_is_never_exceeded),
        cmocka_unit_test(without_adaption_the_row_is_fixed),
        cmocka_unit_test(slow_frames_lead_to_draft_and_fast_ones_back),
        cmocka_unit_test(single_steps_and_frames_at_rest_do_not_count),
        cmocka_unit_test(steady_scenes_do_not_flap),
        cmocka_unit_test(lower_rows_are_not_done),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
