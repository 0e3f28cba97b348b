// Looks a text message over before a parser sees it: strict JSON, valid UTF-8, within limits.
//
// The parser recurses and allocates by what it is given; this scan does neither, so that a hostile
// message costs no more than reading it once. Pure; any thread.
#ifndef VOXCAST_PROTOCOL_JSON_SCAN_H
#define VOXCAST_PROTOCOL_JSON_SCAN_H

#include <stdbool.h>
#include <stddef.h>

// False with a message (NUL-terminated, cut to `size`) that names what is wrong, where and the
// limit. `text` needs no NUL at its end. Cost: linear in `length`.
bool json_scan(const char *text, size_t length, char *out_message, size_t size);

#endif
