// Checks a text message before a parser sees it: strict JSON, valid UTF-8, within limits.
//
// The parser recurses and allocates according to its input. This scan does neither, so that a
// hostile message costs no more than reading it once. Pure; any thread.
#ifndef VOXCAST_PROTOCOL_JSON_SCAN_H
#define VOXCAST_PROTOCOL_JSON_SCAN_H

#include <stdbool.h>
#include <stddef.h>

// False with a message (NUL-terminated, cut to `size`) that names the fault, its position and the
// limit. `text` needs no NUL at its end. Cost: linear in `length`.
bool json_scan(const char *text, size_t length, char *out_message, size_t size);

#endif
