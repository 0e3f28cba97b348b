// Repeatable random numbers, and files and messages broken by them.
#ifndef VOXCAST_SERVER_TOOL_STABILITY_MUTATION_H
#define VOXCAST_SERVER_TOOL_STABILITY_MUTATION_H

#include <stddef.h>
#include <stdint.h>

// SplitMix64 (Steele, Lea and Flood 2014); any state is a seed.
struct random_numbers {
    uint64_t state;
};
uint64_t random_bits(struct random_numbers *random);
uint32_t random_below(struct random_numbers *random, uint32_t count); // 0 to count - 1
double random_unit(struct random_numbers *random);                    // 0 to below 1

// Writes a copy of `bytes` that differs by one to four mutations: bits turned, bytes set, removed,
// doubled or cut off, words made extreme floats or counts, numbers in text made extreme. Returns
// its size, at most `capacity`, which must be at least `size`.
size_t mutate(struct random_numbers *random, const uint8_t *bytes, size_t size, uint8_t *out_bytes,
              size_t capacity);

#endif
