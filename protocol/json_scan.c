#include "protocol/json_scan.h"

#include <math.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "protocol/limits.h"
#include "protocol/utf8.h"

struct scan {
    const char *text;
    size_t length;
    size_t at;
    size_t element_count;
    char *message;
    size_t message_size;
};

static bool fail(struct scan *scan, const char *format, ...) __attribute__((format(printf, 2, 3)));

static bool fail(struct scan *scan, const char *format, ...)
{
    char reason[160];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(reason, sizeof(reason), format, arguments);
    va_end(arguments);
    snprintf(scan->message, scan->message_size, "byte %zu: %s", scan->at, reason);
    return false;
}

static int peek(const struct scan *scan)
{
    return scan->at < scan->length ? (unsigned char)scan->text[scan->at] : -1;
}

static void skip_space(struct scan *scan)
{
    while (scan->at < scan->length && scan->text[scan->at] != '\0' &&
           strchr(" \t\r\n", scan->text[scan->at]))
        scan->at++;
}

static bool is_digit(int c)
{
    return c >= '0' && c <= '9';
}

// Reads the four hexadecimal digits of a \u escape at `at`; -1 if they are missing.
static int32_t read_hex4(const struct scan *scan, size_t at)
{
    if (at + 4 > scan->length)
        return -1;
    int32_t value = 0;
    for (size_t i = at; i < at + 4; i++) {
        char c = scan->text[i];
        int digit = is_digit(c)              ? c - '0'
                    : (c >= 'a' && c <= 'f') ? c - 'a' + 10
                    : (c >= 'A' && c <= 'F') ? c - 'A' + 10
                                             : -1;
        if (digit < 0)
            return -1;
        value = value * 16 + digit;
    }
    return value;
}

static bool scan_escape(struct scan *scan)
{
    scan->at++;
    int c = peek(scan);
    if (c == 'u') {
        int32_t unit = read_hex4(scan, scan->at + 1);
        if (unit <= 0 || (unit >= 0xdc00 && unit <= 0xdfff))
            return fail(scan, "\\u must name a character, and not U+0000");
        scan->at += 5;
        if (unit < 0xd800 || unit > 0xdbff)
            return true;
        int32_t second = -1;
        if (peek(scan) == '\\' && scan->at + 1 < scan->length && scan->text[scan->at + 1] == 'u')
            second = read_hex4(scan, scan->at + 2);
        if (second < 0xdc00 || second > 0xdfff)
            return fail(scan, "half a surrogate pair");
        scan->at += 6;
        return true;
    }
    if (c <= 0 || !strchr("\"\\/bfnrt", c))
        return fail(scan, "unknown escape in a string");
    scan->at++;
    return true;
}

static bool scan_string(struct scan *scan)
{
    size_t start = ++scan->at;
    for (;;) {
        int c = peek(scan);
        if (c < 0)
            return fail(scan, "a string does not end");
        if (scan->at - start > PROTOCOL_MAX_STRING_BYTES)
            return fail(scan, "a string is longer than %u bytes", PROTOCOL_MAX_STRING_BYTES);
        if (c == '"') {
            scan->at++;
            return true;
        }
        if (c < 0x20)
            return fail(scan, "a control character in a string");
        if (c == '\\') {
            if (!scan_escape(scan))
                return false;
            continue;
        }
        size_t count = utf8_sequence_length((const unsigned char *)scan->text + scan->at,
                                            scan->length - scan->at);
        if (count == 0)
            return fail(scan, "not valid UTF-8");
        scan->at += count;
    }
}

static bool skip_digits(struct scan *scan)
{
    if (!is_digit(peek(scan)))
        return fail(scan, "a digit is missing in a number");
    while (is_digit(peek(scan)))
        scan->at++;
    return true;
}

static bool scan_number(struct scan *scan)
{
    size_t start = scan->at;
    if (peek(scan) == '-')
        scan->at++;
    if (peek(scan) == '0')
        scan->at++;
    else if (!skip_digits(scan))
        return false;
    if (peek(scan) == '.') {
        scan->at++;
        if (!skip_digits(scan))
            return false;
    }
    if (peek(scan) == 'e' || peek(scan) == 'E') {
        scan->at++;
        if (peek(scan) == '+' || peek(scan) == '-')
            scan->at++;
        if (!skip_digits(scan))
            return false;
    }
    size_t length = scan->at - start;
    if (length > PROTOCOL_MAX_NUMBER_BYTES)
        return fail(scan, "a number is longer than %u bytes", PROTOCOL_MAX_NUMBER_BYTES);
    char digits[PROTOCOL_MAX_NUMBER_BYTES + 1];
    memcpy(digits, scan->text + start, length);
    digits[length] = '\0';
    if (!isfinite(strtod(digits, NULL)))
        return fail(scan, "the number %s is too large", digits);
    return true;
}

static bool scan_word(struct scan *scan, const char *word)
{
    size_t length = strlen(word);
    if (scan->length - scan->at < length || memcmp(scan->text + scan->at, word, length) != 0)
        return fail(scan, "not JSON");
    scan->at += length;
    return true;
}

static bool scan_scalar(struct scan *scan)
{
    int c = peek(scan);
    if (c == '"')
        return scan_string(scan);
    if (c == '-' || is_digit(c))
        return scan_number(scan);
    if (c == 't')
        return scan_word(scan, "true");
    if (c == 'f')
        return scan_word(scan, "false");
    if (c == 'n')
        return scan_word(scan, "null");
    return fail(scan, c < 0 ? "the text ends too early" : "not JSON");
}

static bool scan_key(struct scan *scan)
{
    skip_space(scan);
    if (peek(scan) != '"')
        return fail(scan, "a key is missing");
    if (!scan_string(scan))
        return false;
    skip_space(scan);
    if (peek(scan) != ':')
        return fail(scan, "':' is missing after a key");
    scan->at++;
    return true;
}

// After a value: closes the objects and arrays that end here. False when done or failed; `*depth`
// is 0 when done.
static bool close_containers(struct scan *scan, const char *closers, size_t *depth)
{
    while (*depth > 0) {
        skip_space(scan);
        int c = peek(scan);
        if (c == ',') {
            scan->at++;
            return closers[*depth - 1] == '}' ? scan_key(scan) : true;
        }
        if (c != closers[*depth - 1])
            return fail(scan, c < 0 ? "the text ends too early" : "',' or an end is missing");
        scan->at++;
        (*depth)--;
    }
    return false;
}

// Opens an object or array. An empty one is closed at once, and `*opened` is false.
static bool open_container(struct scan *scan, char *closers, size_t *depth, bool *opened)
{
    char closer = peek(scan) == '{' ? '}' : ']';
    scan->at++;
    if (*depth == PROTOCOL_MAX_JSON_DEPTH)
        return fail(scan, "nested deeper than %u", PROTOCOL_MAX_JSON_DEPTH);
    skip_space(scan);
    *opened = peek(scan) != closer;
    if (!*opened) {
        scan->at++;
        return true;
    }
    closers[(*depth)++] = closer;
    return closer == ']' || scan_key(scan);
}

static bool scan_value(struct scan *scan)
{
    char closers[PROTOCOL_MAX_JSON_DEPTH];
    size_t depth = 0;
    scan->message[0] = '\0';
    do {
        skip_space(scan);
        if (++scan->element_count > PROTOCOL_MAX_JSON_ELEMENTS)
            return fail(scan, "more than %u values", PROTOCOL_MAX_JSON_ELEMENTS);
        int c = peek(scan);
        bool opened = false;
        if (c == '{' || c == '[') {
            if (!open_container(scan, closers, &depth, &opened))
                return false;
        } else if (!scan_scalar(scan)) {
            return false;
        }
        if (opened)
            continue;
        if (!close_containers(scan, closers, &depth))
            break;
    } while (true);
    return scan->message[0] == '\0';
}

bool json_scan(const char *text, size_t length, char *out_message, size_t size)
{
    struct scan scan = {
        .text = text, .length = length, .message = out_message, .message_size = size};
    if (length > PROTOCOL_MAX_MESSAGE_BYTES)
        return fail(&scan, "the message is longer than %u bytes", PROTOCOL_MAX_MESSAGE_BYTES);
    if (!scan_value(&scan))
        return false;
    skip_space(&scan);
    if (scan.at != length)
        return fail(&scan, "something follows the JSON");
    return true;
}
