// Repeatable random numbers, and mutations of files and messages.
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

// Writes a copy of `bytes` with one to four mutations: bits flipped, bytes set, removed, duplicated
// or cut off, words replaced by extreme floats or counts, numbers in text by extreme ones. Returns
// its size, at most `capacity`, which must be at least `size`.
size_t mutate(struct random_numbers *random, const uint8_t *bytes, size_t size, uint8_t *out_bytes,
              size_t capacity);

#endif
