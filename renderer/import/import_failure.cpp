#include "renderer/import/import_failure.hpp"

#include <cstdarg>
#include <cstdio>

void import_fail(const char *format, ...)
{
    char text[ERROR_MESSAGE_SIZE];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof(text), format, arguments);
    va_end(arguments);
    throw import_failure(text);
}

std::string import_short_name(const std::string &text, size_t size)
{
    size_t length = text.size();
    if (length >= size) {
        length = size - 1;
        while (length > 0 && (text[length] & 0xc0) == 0x80) {
            length--;
        }
    }
    std::string name = text.substr(0, length);
    for (char &character : name) {
        if ((unsigned char)character < 0x20 || character == 0x7f) {
            character = ' ';
        }
    }
    return name;
}
