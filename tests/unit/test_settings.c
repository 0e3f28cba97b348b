// Proves that settings are compared, hashed and copied by the table's column `redraw`: sets each
// row to another value through the document, so that none can be forgotten.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include "server/document/document.h"

// The table's column, in its order.
static const uint32_t redraws[] = {
#define PARAMETER(record, name, type, range, unit, initial, handling, redraw, ...)                 \
    INVALIDATES_##redraw,
#include "protocol/parameters/settings.def"
#undef PARAMETER
};
#define SETTING_COUNT (sizeof(redraws) / sizeof(redraws[0]))

static const struct parameter *setting_at(size_t index)
{
    size_t i = 0;
    while (parameter_at(i)->group != GROUP_SETTINGS)
        i++;
    return parameter_at(i + index);
}

// All defaults but one.
static struct render_settings change(size_t index)
{
    struct render_settings settings;
    render_settings_init(&settings);
    const struct document document = {.settings = &settings};
    const struct parameter *parameter = setting_at(index);
    struct parameter_value value;
    struct rpc_error error;
    assert_int_equal(parameter->group, GROUP_SETTINGS);
    document_get(&document, parameter, 0, &value);
    value.numbers[0] = value.numbers[0] == 0.0 ? 1.0 : 0.0;
    assert_true(document_set(&document, GROUP_SETTINGS, 0, &value, 1, &error));
    return settings;
}

static void changes_tell_what_to_draw_again(void **state)
{
    (void)state;
    struct render_settings before;
    render_settings_init(&before);
    assert_int_equal(render_settings_changes(&before, &before), INVALIDATES_NOTHING);
    for (size_t i = 0; i < SETTING_COUNT; i++) {
        struct render_settings after = change(i);
        assert_int_equal(render_settings_changes(&before, &after), redraws[i]);
        assert_int_equal(render_settings_changes(&after, &before), redraws[i]);
    }
}

static void hashes_differ_where_a_part_is_invalid(void **state)
{
    (void)state;
    struct render_settings before;
    render_settings_init(&before);
    for (uint32_t part = 1; part <= INVALIDATES_DISPLAY; part <<= 1) {
        uint64_t hash = render_settings_hash(&before, part);
        for (size_t i = 0; i < SETTING_COUNT; i++) {
            struct render_settings after = change(i);
            bool differs = render_settings_hash(&after, part) != hash;
            if (differs != ((redraws[i] & part) != 0))
                fail_msg("%s, part %u", setting_at(i)->name, part);
        }
    }
}

static void display_is_taken_over_alone(void **state)
{
    (void)state;
    struct render_settings before;
    render_settings_init(&before);
    for (size_t i = 0; i < SETTING_COUNT; i++) {
        struct render_settings from = change(i), taken = before;
        render_settings_take(&taken, &from, INVALIDATES_DISPLAY);
        bool same = render_settings_changes(&taken, &from) == INVALIDATES_NOTHING;
        assert_int_equal(same, redraws[i] == INVALIDATES_DISPLAY);
        if (!same)
            assert_int_equal(render_settings_changes(&taken, &before), INVALIDATES_NOTHING);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(changes_tell_what_to_draw_again),
        cmocka_unit_test(hashes_differ_where_a_part_is_invalid),
        cmocka_unit_test(display_is_taken_over_alone),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
