// FNV-1a with 64 bits, for keys and tables: hash = hash_word(HASH_START, ...), and so on.
#ifndef VOXCAST_RENDERER_HASH_H
#define VOXCAST_RENDERER_HASH_H

#include <stddef.h>
#include <stdint.h>

#define HASH_START 14695981039346656037ull

// Takes a word of up to 64 bits at once, not byte by byte.
static inline uint64_t hash_word(uint64_t hash, uint64_t word)
{
    return (hash ^ word) * 1099511628211ull;
}

static inline uint64_t hash_bytes(uint64_t hash, const void *bytes, size_t count)
{
    const uint8_t *at = bytes;
    for (size_t i = 0; i < count; i++)
        hash = hash_word(hash, at[i]);
    return hash;
}

#endif
