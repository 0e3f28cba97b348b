// FNV-1a hashes of what light depends on.
#ifndef VOXCAST_RENDERER_GI_VOXEL_LIGHT_HASH_H
#define VOXCAST_RENDERER_GI_VOXEL_LIGHT_HASH_H

#include <stdint.h>
#include <string.h>
#include "shared/voxel_block.h"

static inline uint64_t hash_word(uint64_t hash, uint64_t word)
{
    return (hash ^ word) * 1099511628211ull;
}

static inline uint64_t hash_march(uint64_t hash, const struct cone_march *march)
{
    uint32_t words[sizeof(*march) / 4];
    memcpy(words, march, sizeof(words));
    for (size_t i = 0; i < sizeof(words) / sizeof(words[0]); i++)
        hash = hash_word(hash, words[i]);
    return hash;
}

#endif
