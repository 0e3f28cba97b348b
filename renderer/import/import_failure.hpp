// The importers' internal error: thrown at the cause, and converted to struct error where the
// importer returns to C.
#ifndef VOXCAST_RENDERER_IMPORT_IMPORT_FAILURE_HPP
#define VOXCAST_RENDERER_IMPORT_IMPORT_FAILURE_HPP

#include <exception>
#include <string>

extern "C" {
#include "renderer/error.h"
}

class import_failure : public std::exception
{
  public:
    explicit import_failure(std::string text) : message(std::move(text))
    {
    }

    const char *what() const noexcept override
    {
        return message.c_str();
    }

  private:
    std::string message;
};

// Throws import_failure with a printf-style message.
[[noreturn]] void import_fail(const char *format, ...) __attribute__((format(printf, 1, 2)));

// `text` truncated to `size` - 1 bytes between UTF-8 characters, control characters replaced by
// spaces.
std::string import_short_name(const std::string &text, size_t size);

#endif
