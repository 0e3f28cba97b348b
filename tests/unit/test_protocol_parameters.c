// Proves that the table of parameters is sound and that PROTOCOL.md and the renderer's limits agree
// with it: walks all rows, reads each default back, and looks rows up in the document.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cjson/cJSON.h>
#include <cmocka.h>

#include "protocol/parameter_value.h"
#include "renderer/renderer.h"
#include "voxcast_paths.h"

static char *read_document(void)
{
    FILE *file = fopen(VOXCAST_SOURCE_DIR "/protocol/PROTOCOL.md", "r");
    assert_non_null(file);
    char *text = calloc(1, 1 << 18);
    assert_non_null(text);
    size_t length = fread(text, 1, (1 << 18) - 1, file);
    assert_true(length > 0);
    fclose(file);
    return text;
}

static void document_holds_every_row(void **state)
{
    (void)state;
    char *document = read_document();
    for (size_t i = 0; i < parameter_count(); i++) {
        char row[1024];
        int length = parameter_write_markdown_row(parameter_at(i), row, sizeof(row));
        assert_true(length > 0 && length < (int)sizeof(row));
        if (!strstr(document, row))
            fail_msg("PROTOCOL.md lacks the row: %s", row);
    }
    free(document);
}

static void document_holds_no_other_row(void **state)
{
    (void)state;
    char *document = read_document();
    char *at = strstr(document, "\n|---|---|---|---|---|---|---|---|\n");
    assert_non_null(at);
    size_t rows = 0;
    for (at = strchr(at + 1, '\n'); at && at[1] == '|'; at = strchr(at + 1, '\n'))
        rows++;
    assert_int_equal(rows, parameter_count());
    free(document);
}

static void defaults_are_valid(void **state)
{
    (void)state;
    for (size_t i = 0; i < parameter_count(); i++) {
        struct parameter_value fallback = {.parameter = parameter_at(i)}, value;
        memcpy(fallback.numbers, parameter_at(i)->fallback, sizeof(fallback.numbers));
        cJSON *item = parameter_value_to_json(&fallback);
        struct rpc_error error;
        if (!item || !parameter_value_from_json(parameter_at(i), item, &value, &error))
            fail_msg("default of %s", parameter_at(i)->name);
        cJSON *back = parameter_value_to_json(&value);
        assert_true(cJSON_Compare(item, back, true));
        cJSON_Delete(back);
        cJSON_Delete(item);
    }
}

static void names_are_unique(void **state)
{
    (void)state;
    for (size_t i = 0; i < parameter_count(); i++)
        assert_ptr_equal(parameter_find(parameter_at(i)->group, parameter_at(i)->name),
                         parameter_at(i));
}

// A parameter that needs another names one of its group, some of its values but not all, and a
// reason.
static void needs_can_be_met_and_missed(void **state)
{
    (void)state;
    for (size_t i = 0; i < parameter_count(); i++) {
        const struct parameter *parameter = parameter_at(i);
        for (uint32_t n = 0; n < PARAMETER_MAX_NEEDS && parameter->needs[n].name; n++) {
            const struct parameter_need *need = &parameter->needs[n];
            const struct parameter *needed = parameter_find(parameter->group, need->name);
            if (!needed)
                fail_msg("%s needs %s, which is not there", parameter->name, need->name);
            uint32_t count = needed->type == PARAMETER_BOOL ? 2 : parameter_value_count(needed);
            assert_in_range(count, 2, 31);
            assert_true(need->values > 0 && need->values < (1u << count) - 1);
            assert_true(strlen(need->reason) > 0);
        }
    }
}

static void needs_reach_the_client(void **state)
{
    (void)state;
    cJSON *table = parameters_to_json();
    size_t i = (size_t)(parameter_find(GROUP_SETTINGS, "cone_step") - parameter_at(0));
    cJSON *row = cJSON_GetArrayItem(table, (int)i);
    char *text = cJSON_PrintUnformatted(cJSON_GetObjectItem(row, "needs"));
    char expected[512] = "[{\"name\":\"gi_method\",\"in\":[";
    for (int method = 0; method < GI_METHOD_COUNT; method++)
        if (method != GI_METHOD_NONE) {
            strcat(strcat(strcat(expected, "\""), gi_method_names[method]), "\"");
            strcat(expected, method + 1 < GI_METHOD_COUNT ? "," : "]");
        }
    strcat(expected, ",\"reason\":\"needs a method\"},"
                     "{\"name\":\"gi_method\",\"in\":[\"clipmap\",\"grid\"],"
                     "\"reason\":\"voxels only\"}]");
    assert_string_equal(text, expected);
    free(text);
    assert_null(cJSON_GetObjectItem(cJSON_GetArrayItem(table, 0), "needs"));
    cJSON_Delete(table);
}

static void check_range(const char *name, double max)
{
    const struct parameter *parameter = parameter_find(GROUP_SETTINGS, name);
    assert_non_null(parameter);
    assert_true(parameter->min == 0.0 && parameter->max == max);
}

static void ranges_match_the_renderer(void **state)
{
    (void)state;
    check_range("clip_levels", CLIP_MAX_LEVELS);
    check_range("bounces", 16);
    check_range("cone_step", CONE_STEP_MAX);
}

static void refuse(enum parameter_group group, const char *name, const char *json,
                   const char *message)
{
    cJSON *item = cJSON_Parse(json);
    struct parameter_value value = {.numbers = {-77}};
    struct rpc_error error;
    assert_false(parameter_value_from_json(parameter_find(group, name), item, &value, &error));
    assert_int_equal(error.code, RPC_INVALID_PARAMS);
    assert_string_equal(error.field, name);
    if (!strstr(error.message, message))
        fail_msg("%s=%s: \"%s\" lacks \"%s\"", name, json, error.message, message);
    assert_true(value.numbers[0] == -77.0);
    cJSON_Delete(item);
}

static void wrong_values_are_refused(void **state)
{
    (void)state;
    refuse(GROUP_LIGHT, "intensity", "-1", "-1 is out of range; allowed are 0 to 1e+07");
    refuse(GROUP_LIGHT, "intensity", "\"5\"", "is not a number");
    refuse(GROUP_LIGHT, "color", "[1,1]", "array of 3 numbers");
    refuse(GROUP_LIGHT, "color", "[1,1,2]", "2 is out of range; allowed are 0 to 1");
    refuse(GROUP_LIGHT, "direction", "[0,0,0]", "longer than 0");
    refuse(GROUP_LIGHT, "type", "\"sun\"", "is not one of directional, point, spot");
    refuse(GROUP_LIGHT, "enabled", "1", "true or false");
    refuse(GROUP_VIEW, "width", "640.5", "whole number");
    refuse(GROUP_VIEW, "width", "4097", "allowed are 1 to 4096");
    refuse(GROUP_NODE, "rotation", "[0,0,0,\"1\"]", "made of numbers");
    refuse(GROUP_NODE, "name",
           "\"0123456789012345678901234567890123456789012345678901234567890123\"",
           "allowed are 63");
    refuse(GROUP_NODE, "name", "\"a\\u0007\"", "control characters");
}

static void text_is_read_as_people_type_it(void **state)
{
    (void)state;
    struct parameter_value value;
    struct rpc_error error;
    assert_true(parameter_value_from_text(parameter_find(GROUP_NODE, "translation"), "0,1.5,-2",
                                          &value, &error));
    assert_true(value.numbers[1] == 1.5 && value.numbers[2] == -2.0);
    assert_true(parameter_value_from_text(parameter_find(GROUP_SETTINGS, "tonemap"), "aces", &value,
                                          &error));
    assert_true(value.numbers[0] == TONEMAP_ACES);
    const char *const wrong[] = {"nan", "inf", "-1", "", "1x", "1e999", "0,1"};
    for (size_t i = 0; i < sizeof(wrong) / sizeof(wrong[0]); i++)
        assert_false(parameter_value_from_text(parameter_find(GROUP_LIGHT, "intensity"), wrong[i],
                                               &value, &error));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(document_holds_every_row),
        cmocka_unit_test(document_holds_no_other_row),
        cmocka_unit_test(defaults_are_valid),
        cmocka_unit_test(names_are_unique),
        cmocka_unit_test(needs_can_be_met_and_missed),
        cmocka_unit_test(needs_reach_the_client),
        cmocka_unit_test(ranges_match_the_renderer),
        cmocka_unit_test(wrong_values_are_refused),
        cmocka_unit_test(text_is_read_as_people_type_it),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
