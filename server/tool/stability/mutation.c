#include "server/tool/stability/mutation.h"

#include <ctype.h>
#include <string.h>

#define MAX_MUTATIONS 4u
#define MAX_RANGE     64u

// Text in place of a number.
static const char *const numbers[] = {
    "-1",    "0",    "-0",         "1e38",       "-1e38",      "1e308", "1e-320",
    "1e999", "0.5",  "2147483647", "2147483648", "4294967295", "NaN",   "9007199254740993",
    "null",  "true", "\"\"",       "[]",         "{}",         "65536", "-2147483649",
};

// Words of four bytes that floats and counts in binary data may become.
static const uint32_t words[] = {
    0,          1,          0xffffffff, 0x7fffffff, 0x80000000, 0x7f800000, // infinity
    0xff800000, 0x7fc00000, 0x7f7fffff, 0xff7fffff, 0x00000001, 0x7e967699, // NaN; 1e38
};

uint64_t random_bits(struct random_numbers *random)
{
    uint64_t z = random->state += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

uint32_t random_below(struct random_numbers *random, uint32_t count)
{
    return (uint32_t)((random_bits(random) >> 32) * count >> 32);
}

double random_unit(struct random_numbers *random)
{
    return (double)(random_bits(random) >> 11) * 0x1p-53;
}

// Replaces `length` bytes at an offset by others. Does nothing where there is no room.
static size_t replace(uint8_t *bytes, size_t size, size_t capacity, size_t at, size_t length,
                      const void *by, size_t by_length)
{
    if (size - length + by_length > capacity)
        return size;
    uint8_t copy[MAX_RANGE];
    memcpy(copy, by, by_length); // `by` may lie within the buffer
    memmove(bytes + at + by_length, bytes + at + length, size - at - length);
    memcpy(bytes + at, copy, by_length);
    return size - length + by_length;
}

static size_t mutate_number(struct random_numbers *random, uint8_t *bytes, size_t size,
                            size_t capacity)
{
    size_t at = random_below(random, (uint32_t)size);
    while (at < size && !isdigit(bytes[at]))
        at++;
    size_t length = 0;
    while (at + length < size && length < MAX_RANGE &&
           strchr("0123456789.eE+-", bytes[at + length]))
        length++;
    const char *by = numbers[random_below(random, sizeof(numbers) / sizeof(numbers[0]))];
    return length == 0 ? size : replace(bytes, size, capacity, at, length, by, strlen(by));
}

static size_t mutate_once(struct random_numbers *random, uint8_t *bytes, size_t size,
                          size_t capacity)
{
    size_t at = random_below(random, (uint32_t)size);
    size_t length = random_below(random, MAX_RANGE);
    length = length < size - at ? length : size - at;
    switch (random_below(random, 8)) {
    case 0:
        bytes[at] ^= (uint8_t)(1u << random_below(random, 8));
        return size;
    case 1:
        bytes[at] = (uint8_t)random_bits(random);
        return size;
    case 2:
        return replace(bytes, size, capacity, at, length, "", 0);
    case 3:
        return replace(bytes, size, capacity, at, 0, bytes + at, length);
    case 4:
        return at + 1;
    case 5:
        if (size >= sizeof(words[0]))
            memcpy(bytes + (at & ~(size_t)3) - (at + 4 > size ? 4 : 0),
                   &words[random_below(random, sizeof(words) / sizeof(words[0]))],
                   sizeof(words[0]));
        return size;
    default:
        return mutate_number(random, bytes, size, capacity);
    }
}

size_t mutate(struct random_numbers *random, const uint8_t *bytes, size_t size, uint8_t *out_bytes,
              size_t capacity)
{
    memcpy(out_bytes, bytes, size);
    uint32_t count = 1 + random_below(random, MAX_MUTATIONS);
    for (uint32_t i = 0; i < count && size > 8; i++)
        size = mutate_once(random, out_bytes, size, capacity);
    return size;
}
