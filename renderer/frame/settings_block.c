#include "renderer/frame/settings_block.h"

#include <stdio.h>
#include <string.h>

#define WORD_FLOAT      float
#define WORD_INT        uint32_t
#define WORD_BOOL       uint32_t
#define WORD_ENUM(name) uint32_t
#define TYPE_FLOAT      "float"
#define TYPE_INT        "uint"
#define TYPE_BOOL       "uint"
#define TYPE_ENUM(name) "uint"

void settings_block_fill(const struct render_settings *settings,
                         uint32_t out_words[SETTINGS_WORD_COUNT])
{
#define PARAMETER(record, name, type, ...)                                                         \
    {                                                                                              \
        WORD_##type word = (WORD_##type)settings->name;                                            \
        memcpy(&out_words[SETTINGS_WORD_##name], &word, sizeof(word));                             \
    }
#include "protocol/parameters/settings.def"
#undef PARAMETER
}

void settings_block_write_define(char out_define[SETTINGS_DEFINE_BYTES])
{
    static const char members[] = "SETTINGS_MEMBERS"
#define PARAMETER(record, name, type, ...) " " TYPE_##type " " #name ";"
#include "protocol/parameters/settings.def"
#undef PARAMETER
        ;
    _Static_assert(sizeof(members) + 1 < SETTINGS_DEFINE_BYTES, "the line must fit");
    snprintf(out_define, SETTINGS_DEFINE_BYTES, "%s\n", members);
}
