// The settings as shaders read them: a uniform block with a member of the same name for each row of
// protocol/parameters/settings.def.
#ifndef VOXCAST_RENDERER_FRAME_SETTINGS_BLOCK_H
#define VOXCAST_RENDERER_FRAME_SETTINGS_BLOCK_H

#include <stddef.h>

#include "renderer/settings.h"

// Number of settings; each is one word, a float or an unsigned integer (booleans 0 or 1).
enum settings_word {
#define PARAMETER(record, name, ...) SETTINGS_WORD_##name,
#include "protocol/parameters/settings.def"
#undef PARAMETER
    SETTINGS_WORD_COUNT
};

void settings_block_fill(const struct render_settings *settings,
                         uint32_t out_words[SETTINGS_WORD_COUNT]);

#define SETTINGS_DEFINE_BYTES 1024u

// A line of defines, SETTINGS_MEMBERS, which declares the members in GLSL.
void settings_block_write_define(char out_define[SETTINGS_DEFINE_BYTES]);

#endif
