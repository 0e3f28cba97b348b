#include <cstring>

#include "renderer/import/obj_import.hpp"

#define ENCODED_SPACE        '\x02'
#define OBJ_MAX_INDEX_DIGITS 9

// The next logical line from `at` on: continuations joined, comment and line ends removed, trimmed.
// Characters that end strings or that our encodings use become '?'.
static bool next_line(const char *bytes, size_t size, size_t &at, std::string &line)
{
    line.clear();
    if (at >= size) {
        return false;
    }
    while (at < size) {
        const char *start = bytes + at;
        const char *end = (const char *)memchr(start, '\n', size - at);
        size_t length = end ? (size_t)(end - start) : size - at;
        at += length + 1;
        if (length > 0 && start[length - 1] == '\r') {
            length--;
        }
        bool continued = length > 0 && start[length - 1] == '\\';
        line.append(start, continued ? length - 1 : length);
        if (!continued) {
            break;
        }
        line += ' ';
    }
    size_t comment = line.find('#');
    if (comment != std::string::npos) {
        line.resize(comment);
    }
    for (char &character : line) {
        if (character == '\t' || character == '\r' || character == '\v' || character == '\f') {
            character = ' ';
        } else if ((unsigned char)character < 0x20) {
            character = '?';
        }
    }
    size_t first = line.find_first_not_of(' ');
    size_t last = line.find_last_not_of(' ');
    line = first == std::string::npos ? "" : line.substr(first, last - first + 1);
    return true;
}

static bool take_keyword(const std::string &line, const char *keyword, std::string &rest)
{
    size_t length = strlen(keyword);
    if (line.compare(0, length, keyword) != 0 || line.size() <= length || line[length] != ' ') {
        return false;
    }
    rest = line.substr(line.find_first_not_of(' ', length));
    return true;
}

static void check_index_digits(const std::string &line)
{
    uint32_t digits = 0;
    for (char character : line) {
        digits = character >= '0' && character <= '9' ? digits + 1 : 0;
        if (digits > OBJ_MAX_INDEX_DIGITS) {
            import_fail("a face has an index of more than %u digits: '%.60s'", OBJ_MAX_INDEX_DIGITS,
                        import_short_name(line, 60).c_str());
        }
    }
}

// NaN or infinity: contains letters other than an exponent's.
static bool has_odd_number(const std::string &line)
{
    return line.find_first_not_of("0123456789+-.eE ", 2) != std::string::npos;
}

std::string obj_normalize_text(const char *bytes, size_t size,
                               std::vector<std::string> &out_libraries)
{
    std::string text, line, rest;
    text.reserve(size);
    for (size_t at = 0; next_line(bytes, size, at, line);) {
        if (take_keyword(line, "mtllib", rest)) {
            out_libraries.push_back(rest);
        } else if (take_keyword(line, "s", rest)) {
            text += std::string("g ") + OBJ_SMOOTHING_PREFIX + rest + "\n";
        } else if (take_keyword(line, "v", rest)) {
            // Out of the range of floats, so that its faces are dropped.
            text += has_odd_number(line) ? "v 1e39 1e39 1e39" : line;
            text += '\n';
        } else if (take_keyword(line, "f", rest)) {
            check_index_digits(line);
            text += line + "\n";
        } else if (take_keyword(line, "vn", rest) || take_keyword(line, "vt", rest) ||
                   take_keyword(line, "usemtl", rest)) {
            text += line + "\n";
        }
    }
    return text;
}

static bool is_number(const std::string &token)
{
    return !token.empty() && token.find_first_not_of("0123456789+-.eE") == std::string::npos;
}

static std::string take_token(std::string &rest)
{
    size_t end = rest.find(' ');
    std::string token = rest.substr(0, end);
    size_t next = end == std::string::npos ? end : rest.find_first_not_of(' ', end);
    rest = next == std::string::npos ? "" : rest.substr(next);
    return token;
}

// "-bm 2 -o 0 0 my file.png" to "-bm 2 my\x02file.png".
static std::string normalize_texture(std::string rest)
{
    std::string kept;
    while (rest.size() > 1 && rest[0] == '-') {
        std::string option = take_token(rest);
        bool is_vector = option == "-o" || option == "-s" || option == "-t";
        bool is_pair = option == "-mm";
        std::string values;
        for (int i = 0; i < (is_vector ? 3 : is_pair ? 2 : 1) && !rest.empty(); i++) {
            std::string token = rest.substr(0, rest.find(' '));
            if ((is_vector || is_pair) && !is_number(token)) {
                break;
            }
            values = take_token(rest);
        }
        if (option == "-bm" && is_number(values)) {
            kept = "-bm " + values + " ";
        }
    }
    for (char &character : rest) {
        character = character == ' ' ? ENCODED_SPACE : character;
    }
    return kept + rest;
}

std::string obj_normalize_materials(const char *bytes, size_t size)
{
    static const char *const MAPS[] = {"map_Kd", "map_d",  "map_Bump", "map_bump", "bump",
                                       "map_Pr", "map_Pm", "map_Ke",   "norm"};
    std::string text, line, rest;
    for (size_t at = 0; next_line(bytes, size, at, line);) {
        for (const char *map : MAPS) {
            if (take_keyword(line, map, rest)) {
                line = std::string(map) + " " + normalize_texture(rest);
            }
        }
        text += line + "\n";
        for (const char *key : {"Pr", "Pm", "map_Pr", "map_Pm"}) {
            if (take_keyword(line, key, rest)) {
                text += OBJ_PBR_KEY " 1\n";
            }
        }
    }
    return text;
}

std::string obj_decode_name(const std::string &encoded)
{
    std::string name = encoded;
    for (char &character : name) {
        if (character == ENCODED_SPACE) {
            character = ' ';
        } else if (character == '\\') {
            character = '/';
        }
    }
    return name;
}
