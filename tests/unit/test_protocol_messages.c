// Proves that messages are checked against their limits before they are parsed, and that requests
// become commands or the error that PROTOCOL.md states: sends texts and compares codes and fields.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cjson/cJSON.h>
#include <cmocka.h>

#include "protocol/command.h"
#include "protocol/frame_header.h"
#include "protocol/json_scan.h"
#include "protocol/utf8.h"

static bool scan(const char *text)
{
    char message[128];
    return json_scan(text, strlen(text), message, sizeof(message));
}

static void strict_json_passes_and_nothing_else(void **state)
{
    (void)state;
    const char *const good[] = {"{}", " [1,-0.5e+3,\"\\u00e9\\ud83d\\ude00\",null,true,false] ",
                                "{\"a\":{\"b\":[[],{}]}}", "\"\xc3\xa9\"", "0"};
    const char *const bad[] = {"",
                               "{",
                               "[1,]",
                               "{\"a\"}",
                               "{\"a\":}",
                               "{a:1}",
                               "[01]",
                               "[1.]",
                               "[.5]",
                               "[+1]",
                               "NaN",
                               "[Infinity]",
                               "[1e999]",
                               "[-1e999]",
                               "\"\\u0000\"",
                               "\"\\ud800\"",
                               "\"\\x\"",
                               "\"\x01\"",
                               "\"\xff\"",
                               "\"\xc0\x80\"",
                               "\"\xed\xa0\x80\"",
                               "\"\xc3",
                               "[1] 2",
                               "tru",
                               "[1}",
                               "{\"a\":1]",
                               "'a'",
                               "// x\n1"};
    for (size_t i = 0; i < sizeof(good) / sizeof(good[0]); i++) {
        if (!scan(good[i]))
            fail_msg("refused: %s", good[i]);
    }
    for (size_t i = 0; i < sizeof(bad) / sizeof(bad[0]); i++) {
        if (scan(bad[i]))
            fail_msg("let through: %s", bad[i]);
    }
}

// A text of `count` times `part` between `before` and `after`.
static bool scan_repeated(const char *before, const char *part, size_t count, const char *after)
{
    char *text = calloc(1, strlen(before) + strlen(part) * count + strlen(after) + 1);
    assert_non_null(text);
    strcpy(text, before);
    char *at = text + strlen(before);
    for (size_t i = 0; i < count; i++, at += strlen(part))
        memcpy(at, part, strlen(part));
    strcpy(at, after);
    bool passed = scan(text);
    free(text);
    return passed;
}

static void limits_hold_to_the_last_one(void **state)
{
    (void)state;
    assert_true(scan_repeated("[[[[[[[[[[[[[[[[", "]", 16, ""));
    assert_false(scan_repeated("[[[[[[[[[[[[[[[[[", "]", 17, ""));
    assert_true(scan_repeated("\"", "a", PROTOCOL_MAX_STRING_BYTES, "\""));
    assert_false(scan_repeated("\"", "a", PROTOCOL_MAX_STRING_BYTES + 1, "\""));
    assert_true(scan_repeated("", "1", PROTOCOL_MAX_NUMBER_BYTES, ""));
    assert_false(scan_repeated("", "1", PROTOCOL_MAX_NUMBER_BYTES + 1, ""));
    assert_true(scan_repeated("[", "1,", PROTOCOL_MAX_JSON_ELEMENTS - 2, "1]"));
    assert_false(scan_repeated("[", "1,", PROTOCOL_MAX_JSON_ELEMENTS - 1, "1]"));
    assert_true(scan_repeated("", " ", PROTOCOL_MAX_MESSAGE_BYTES - 1, "1"));
    assert_false(scan_repeated("", " ", PROTOCOL_MAX_MESSAGE_BYTES, "1"));
}

// Parses a message to a command; 0 or the error's code.
static int parse(const char *text, struct command *out_command, struct rpc_error *out_error)
{
    struct rpc_request request;
    if (!rpc_request_parse(text, strlen(text), &request, out_error))
        return out_error->code;
    bool fine = command_parse(&request, out_command, out_error);
    rpc_request_finish(&request);
    return fine ? 0 : out_error->code;
}

#define REQUEST(method, params)                                                                    \
    "{\"jsonrpc\":\"2.0\",\"id\":1,\"method\":\"" method "\",\"params\":" params "}"

static void requests_fail_with_the_stated_code(void **state)
{
    (void)state;
    const struct {
        const char *text;
        int code;
        const char *field;
    } cases[] = {
        {"{", RPC_PARSE_ERROR, ""},
        {"[]", RPC_INVALID_REQUEST, ""},
        {"1", RPC_INVALID_REQUEST, ""},
        {"{\"jsonrpc\":\"1.0\",\"method\":\"pick\"}", RPC_INVALID_REQUEST, ""},
        {"{\"jsonrpc\":\"2.0\",\"id\":{},\"method\":\"pick\"}", RPC_INVALID_REQUEST, ""},
        {"{\"jsonrpc\":\"2.0\",\"method\":\"pick\",\"x\":1}", RPC_INVALID_REQUEST, ""},
        {REQUEST("pick", "{\"x\":1,\"x\":2}"), RPC_INVALID_REQUEST, ""},
        {REQUEST("nothing", "{}"), RPC_METHOD_NOT_FOUND, ""},
        {REQUEST("pick", "[1,2]"), RPC_INVALID_PARAMS, ""},
        {REQUEST("pick", "{\"x\":1}"), RPC_INVALID_PARAMS, "y"},
        {REQUEST("pick", "{\"x\":1,\"y\":-1}"), RPC_INVALID_PARAMS, "y"},
        {REQUEST("light.update", "{\"set\":{\"intensity\":1}}"), RPC_INVALID_PARAMS, "id"},
        {REQUEST("light.update", "{\"id\":0}"), RPC_INVALID_PARAMS, "set"},
        {REQUEST("light.update", "{\"id\":0,\"set\":{}}"), RPC_INVALID_PARAMS, "set"},
        {REQUEST("light.update", "{\"id\":0.5,\"set\":{\"intensity\":1}}"), RPC_INVALID_PARAMS,
         "id"},
        {REQUEST("light.update", "{\"id\":0,\"set\":{\"roughness\":1}}"), RPC_INVALID_PARAMS,
         "roughness"},
        {REQUEST("session.hello", "{\"protocol\":2}"), RPC_INVALID_PARAMS, "protocol"},
        {REQUEST("camera.set", "{\"eye\":[0,0,1e30]}"), RPC_INVALID_PARAMS, "eye"},
        {REQUEST("accuracy.start", "{\"ladder\":\"steep\"}"), RPC_INVALID_PARAMS, "ladder"},
        {REQUEST("accuracy.start", "{\"ladder\":1}"), RPC_INVALID_PARAMS, "ladder"},
        {REQUEST("accuracy.start", "{\"noise\":0.2}"), RPC_INVALID_PARAMS, "noise"},
        {REQUEST("accuracy.start", "{\"noise\":0.0004}"), RPC_INVALID_PARAMS, "noise"},
        {REQUEST("accuracy.start", "{\"noise\":\"0.01\"}"), RPC_INVALID_PARAMS, "noise"},
        {REQUEST("accuracy.start", "{\"seconds\":0}"), RPC_INVALID_PARAMS, "seconds"},
        {REQUEST("accuracy.start", "{\"seconds\":86401}"), RPC_INVALID_PARAMS, "seconds"},
        {REQUEST("accuracy.start", "{\"rung\":\"draft\"}"), RPC_INVALID_PARAMS, "rung"},
        {REQUEST("accuracy.cancel", "{\"ladder\":\"quick\"}"), RPC_INVALID_PARAMS, "ladder"},
    };
    struct command *command = malloc(sizeof(*command));
    for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
        struct rpc_error error;
        int code = parse(cases[i].text, command, &error);
        if (code != cases[i].code || strcmp(error.field, cases[i].field) != 0)
            fail_msg("%s: code %d, field \"%s\"", cases[i].text, code, error.field);
    }
    free(command);
}

static void requests_become_commands(void **state)
{
    (void)state;
    struct command *command = malloc(sizeof(*command));
    struct rpc_error error;
    assert_int_equal(parse(REQUEST("light.update", "{\"id\":3,\"set\":{\"intensity\":20,\"color\":"
                                                   "[1,0,0.5]},\"edit_id\":12,\"transient\":true}"),
                           command, &error),
                     0);
    assert_int_equal(command->method, METHOD_LIGHT_UPDATE);
    assert_int_equal(command->target, 3);
    assert_true(command->has_edit_id && command->edit_id == 12 && command->transient);
    assert_int_equal(command->value_count, 2);
    assert_string_equal(command->values[0].parameter->name, "intensity");
    assert_true(command->values[1].numbers[2] == 0.5);
    assert_string_equal(command->id.json, "1");
    assert_int_equal(
        parse("{\"jsonrpc\":\"2.0\",\"method\":\"frame.ack\",\"params\":{\"frame_id\":9}}", command,
              &error),
        0);
    assert_string_equal(command->id.json, "");
    assert_true(command->revision == 9);
    assert_int_equal(parse(REQUEST("accuracy.start", "{}"), command, &error), 0);
    assert_int_equal(command->sweep, SWEEP_QUICK);
    assert_true(command->noise == 0.01 && command->seconds == 120.0);
    assert_int_equal(
        parse(REQUEST("accuracy.start", "{\"ladder\":\"full\",\"noise\":0.0005,\"seconds\":1}"),
              command, &error),
        0);
    assert_int_equal(command->sweep, SWEEP_FULL);
    assert_true(command->noise == 0.0005 && command->seconds == 1.0);
    assert_int_equal(method_get_flags(METHOD_ACCURACY_START), 0);
    free(command);
}

static void errors_tell_field_and_range_in_valid_utf8(void **state)
{
    (void)state;
    struct command *command = malloc(sizeof(*command));
    struct rpc_error error;
    parse(REQUEST("accuracy.start", "{\"ladder\":\"steep\"}"), command, &error);
    assert_non_null(strstr(error.message, "quick, full"));
    parse(REQUEST("settings.update", "{\"set\":{\"exposure_ev\":99}}"), command, &error);
    char *text = rpc_write_error(&command->id, &error);
    cJSON *reply = cJSON_Parse(text);
    cJSON *data = cJSON_GetObjectItem(cJSON_GetObjectItem(reply, "error"), "data");
    assert_string_equal(cJSON_GetObjectItem(data, "field")->valuestring, "exposure_ev");
    assert_string_equal(cJSON_GetObjectItem(data, "value")->valuestring, "99");
    assert_true(cJSON_GetObjectItem(data, "min")->valuedouble == -16.0);
    assert_true(cJSON_GetObjectItem(data, "max")->valuedouble == 16.0);
    cJSON_Delete(reply);
    free(text);
    // A key of two-byte letters that the error message cuts inside a letter.
    char request[512] = "{\"jsonrpc\":\"2.0\",\"id\":1,\"method\":\"pick\",\"params\":{\"a";
    for (int i = 0; i < 60; i++)
        strcat(request, "\xc3\xa9");
    strcat(request, "\":1}}");
    parse(request, command, &error);
    text = rpc_write_error(&command->id, &error);
    for (size_t at = 0, left = strlen(text); left > 0;) {
        size_t count = utf8_sequence_length((unsigned char *)text + at, left);
        assert_true(count > 0);
        at += count;
        left -= count;
    }
    free(text);
    free(command);
}

static void frame_headers_keep_every_field(void **state)
{
    (void)state;
    struct frame_header header = {
        .flags = 1,
        .codec = 7,
        .view_id = 2,
        .jpeg_bytes = 5,
        .frame_id = 1ull << 40,
        .scene_revision = 4,
        .edit_id = 5,
        .camera_revision = 6,
        .width = 3840,
        .height = 2160,
        .quality = 3,
        .debug_view = 7,
        .epoch = 65535,
        .convergence = 0.25f,
        .queue_us = 8,
        .draw_us = 9,
        .readback_us = 10,
        .encode_us = 11,
        .send_wait_us = 12,
        .draw_at_us = 13,
        .sent_at_us = 14,
        .reference_samples = 15,
        .reference_noise = 2.0f,
    };
    uint8_t bytes[FRAME_HEADER_BYTES + 5];
    memset(bytes, 0xaa, sizeof(bytes));
    frame_header_encode(&header, bytes);
    // Offsets as PROTOCOL.md states them.
    assert_memory_equal(bytes, "VXF1\x68\x00\x01\x07\x02\x00\x00\x00\x05\x00\x00\x00", 16);
    assert_int_equal(bytes[16 + 5], 1);
    assert_int_equal(bytes[48] | bytes[49] << 8, 3840);
    assert_int_equal(bytes[52], 3);
    assert_int_equal(bytes[76], 12);
    assert_int_equal(bytes[88], 14);
    assert_int_equal(bytes[96], 15);
    assert_int_equal(bytes[103], 0x40);
    struct frame_header back;
    size_t offset = 0;
    assert_true(frame_header_decode(bytes, sizeof(bytes), &back, &offset));
    assert_int_equal(offset, FRAME_HEADER_BYTES);
    uint8_t again[FRAME_HEADER_BYTES];
    frame_header_encode(&back, again);
    assert_memory_equal(bytes, again, FRAME_HEADER_BYTES);
    assert_false(frame_header_decode(bytes, sizeof(bytes) - 1, &back, &offset));
    assert_false(frame_header_decode(bytes, 10, &back, &offset));
    bytes[0] = 'X';
    assert_false(frame_header_decode(bytes, sizeof(bytes), &back, &offset));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(strict_json_passes_and_nothing_else),
        cmocka_unit_test(limits_hold_to_the_last_one),
        cmocka_unit_test(requests_fail_with_the_stated_code),
        cmocka_unit_test(requests_become_commands),
        cmocka_unit_test(errors_tell_field_and_range_in_valid_utf8),
        cmocka_unit_test(frame_headers_keep_every_field),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
