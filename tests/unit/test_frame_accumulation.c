// Proves how samples of pixels accumulate over frames: how many, when they are shown, and what
// makes them stale. No GPU is needed.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "support_frame.h"

// Draws the same view until it is final. Returns the number of images among the frames.
static uint32_t draw_to_rest(struct situation *it, uint32_t *out_frames)
{
    struct frame_plan plan;
    uint32_t images = 0;
    for (*out_frames = 0; *out_frames < 1000; (*out_frames)++) {
        frame_plan_make(&plan, &it->inputs);
        assert_int_equal(plan.accumulation.gather, plan.quality.gather_mode);
        images += !plan.accumulation.only;
        it->history.accumulation = plan.accumulation_after;
        if (plan.accumulation.samples == plan.accumulation.target) {
            assert_false(plan.accumulation.only);
            *out_frames += 1;
            return images;
        }
        assert_true(plan.accumulation.sample);
    }
    fail_msg("never at rest");
    return 0;
}

static void samples_accumulate_until_all_are_in(void **state)
{
    (void)state;
    struct situation it;
    uint32_t frames;
    at_rest(&it);
    // 64 samples: shown with 16, 32 and 64.
    assert_int_equal(draw_to_rest(&it, &frames), 3);
    assert_int_equal(frames, 64);
    at_rest(&it);
    it.params.settings.bounces = it.history.params.settings.bounces = 2;
    assert_int_equal(draw_to_rest(&it, &frames), 7); // with 1, 2, 4 ... 64
    at_rest(&it);
    it.params.settings.gather_mode = it.history.params.settings.gather_mode = GATHER_PIXEL;
    assert_int_equal(draw_to_rest(&it, &frames), 4);
    assert_int_equal(frames, 4);
}

static void samples_are_forgotten_where_they_are_stale(void **state)
{
    (void)state;
    void (*const changes[])(struct situation *) = {camera_moves,     size_changes,
                                                   material_changes, light_changes,
                                                   bounces_change,   debug_view_changes};
    struct frame_plan plan;
    for (size_t i = 0; i < sizeof(changes) / sizeof(changes[0]); i++) {
        struct situation it;
        at_rest(&it);
        all_samples_are_in(&it);
        frame_plan_make(&plan, &it.inputs);
        assert_int_equal(plan.accumulation.samples, 64);
        assert_false(plan.accumulation.sample);
        changes[i](&it);
        frame_plan_make(&plan, &it.inputs);
        assert_in_range(plan.accumulation_after.samples, 0, 1);
    }
    struct situation it;
    at_rest(&it);
    all_samples_are_in(&it);
    tonemap_changes(&it); // needs none anew
    frame_plan_make(&plan, &it.inputs);
    assert_int_equal(plan.accumulation.samples, 64);
}

static void converging_light_is_shown_now_and_then(void **state)
{
    (void)state;
    struct situation it;
    struct frame_plan plan;
    uint32_t images = 0;
    at_rest(&it);
    it.gi.light_converged = false;
    for (int i = 0; i < 64; i++) {
        frame_plan_make(&plan, &it.inputs);
        assert_int_equal(plan.accumulation.gather, GATHER_CACHE);
        images += !plan.accumulation.only;
        it.history.shown_light = plan.shown_light_after;
        it.history.accumulate_only_count = plan.accumulate_only_count_after;
    }
    assert_int_equal(images, 8);
    it.gi.light_version++; // cones see other light: shown at once
    frame_plan_make(&plan, &it.inputs);
    assert_false(plan.accumulation.only);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(samples_accumulate_until_all_are_in),
        cmocka_unit_test(samples_are_forgotten_where_they_are_stale),
        cmocka_unit_test(converging_light_is_shown_now_and_then),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
