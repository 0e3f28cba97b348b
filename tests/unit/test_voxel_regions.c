// Proves the arithmetic of voxel boxes by counting voxels one by one. Slabs that come in are
// disjoint and are exactly what was not covered before. Boxes that are added stay disjoint, cover
// all that was added, and stay within its bounds.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "renderer/gi/voxel/regions.h"

#define SPACE 20 // voxels along an edge of the space that holds the boxes
#define LEVEL 8

static uint64_t seed;

static int32_t random_below(int32_t end)
{
    seed = seed * 6364136223846793005ull + 1442695040888963407ull;
    return (int32_t)((seed >> 33) % (uint64_t)end);
}

static bool holds(const struct voxel_box *box, int32_t x, int32_t y, int32_t z)
{
    return x >= box->low[0] && x < box->high[0] && y >= box->low[1] && y < box->high[1] &&
           z >= box->low[2] && z < box->high[2];
}

static uint32_t count_holding(const struct voxel_boxes *boxes, int32_t x, int32_t y, int32_t z)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < boxes->count; i++)
        count += holds(&boxes->boxes[i], x, y, z);
    return count;
}

static struct voxel_box level_at(const int32_t low[3])
{
    struct voxel_box box;
    for (int axis = 0; axis < 3; axis++) {
        box.low[axis] = low[axis];
        box.high[axis] = low[axis] + LEVEL;
    }
    return box;
}

static void test_entered_slabs(void **state)
{
    (void)state;
    seed = 1;
    for (int round = 0; round < 2000; round++) {
        int32_t lows[2][3];
        for (int i = 0; i < 6; i++)
            lows[i / 3][i % 3] = random_below(round % 2 ? SPACE - LEVEL : 4);
        struct voxel_box before = level_at(lows[0]), now = level_at(lows[1]);
        struct voxel_boxes entered;
        voxel_boxes_entered(&entered, &before, &now);
        assert_true(entered.count <= 3);
        for (uint32_t i = 0; i < entered.count; i++)
            assert_false(voxel_box_is_empty(&entered.boxes[i]));
        for (int32_t z = 0; z < SPACE; z++)
            for (int32_t y = 0; y < SPACE; y++)
                for (int32_t x = 0; x < SPACE; x++)
                    assert_int_equal(count_holding(&entered, x, y, z),
                                     holds(&now, x, y, z) && !holds(&before, x, y, z));
    }
}

static void check_sum(const struct voxel_boxes *boxes, const struct voxel_box *added,
                      uint32_t count)
{
    struct voxel_box bounds = added[0];
    for (uint32_t i = 1; i < count; i++)
        for (int axis = 0; axis < 3; axis++) {
            if (added[i].low[axis] < bounds.low[axis])
                bounds.low[axis] = added[i].low[axis];
            if (added[i].high[axis] > bounds.high[axis])
                bounds.high[axis] = added[i].high[axis];
        }
    for (uint32_t i = 0; i < boxes->count; i++)
        assert_true(voxel_box_contains(&bounds, &boxes->boxes[i]));
    for (int32_t z = 0; z < SPACE; z++)
        for (int32_t y = 0; y < SPACE; y++)
            for (int32_t x = 0; x < SPACE; x++) {
                uint32_t holding = count_holding(boxes, x, y, z);
                assert_true(holding <= 1);
                for (uint32_t i = 0; i < count && holding == 0; i++)
                    assert_false(holds(&added[i], x, y, z));
            }
}

static void test_added_boxes_stay_disjoint(void **state)
{
    (void)state;
    seed = 2;
    for (int round = 0; round < 300; round++) {
        struct voxel_boxes boxes = {0};
        struct voxel_box added[24];
        uint32_t count = 1 + (uint32_t)random_below(24);
        for (uint32_t i = 0; i < count; i++) {
            for (int axis = 0; axis < 3; axis++) {
                added[i].low[axis] = random_below(SPACE - 5);
                added[i].high[axis] = added[i].low[axis] + 1 + random_below(round % 2 ? 2 : 5);
            }
            voxel_boxes_add(&boxes, added[i]);
            assert_true(boxes.count <= VOXEL_MAX_REGIONS / VOXEL_MAX_LEVELS);
            if (i + 1 == count || i % 8 == 0)
                check_sum(&boxes, added, i + 1);
        }
    }
}

static void test_empty_boxes_are_not_added(void **state)
{
    (void)state;
    struct voxel_boxes boxes = {0};
    voxel_boxes_add(&boxes, (struct voxel_box){{1, 1, 1}, {1, 5, 5}});
    voxel_boxes_add(&boxes, (struct voxel_box){{4, 4, 4}, {3, 5, 5}});
    assert_int_equal(boxes.count, 0);
}

static void test_boxes_that_touch_stay_apart(void **state)
{
    (void)state;
    struct voxel_boxes boxes = {0};
    voxel_boxes_add(&boxes, (struct voxel_box){{0, 0, 0}, {2, 2, 2}});
    voxel_boxes_add(&boxes, (struct voxel_box){{2, 0, 0}, {4, 2, 2}});
    assert_int_equal(boxes.count, 2);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_entered_slabs),
        cmocka_unit_test(test_added_boxes_stay_disjoint),
        cmocka_unit_test(test_empty_boxes_are_not_added),
        cmocka_unit_test(test_boxes_that_touch_stay_apart),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
