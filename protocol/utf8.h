// UTF-8 checks. Pure.
#ifndef VOXCAST_PROTOCOL_UTF8_H
#define VOXCAST_PROTOCOL_UTF8_H

#include <stddef.h>

// Length of the sequence at `bytes`; 0 if it is not valid or `left` cuts it. Overlong forms,
// surrogates and code points beyond U+10FFFF are not valid (Unicode 15, table 3-7). `left` is at
// least 1.
size_t utf8_sequence_length(const unsigned char *bytes, size_t left);

// Replaces bytes that are not valid UTF-8, such as the end of a cut text, by '?'.
void utf8_repair(char *text);

#endif
