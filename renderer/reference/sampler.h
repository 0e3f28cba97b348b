// Low-discrepancy random numbers: for each use along a path (a dimension pair) the first two
// dimensions of Sobol's sequence, its points shuffled and scrambled by hashing as Owen would
// (Burley 2020, "Practical Hash-based Owen Scrambling"; the hash is that of Laine and Karras 2011
// with Vegdahl's constants). Nothing is stored: a number depends on seed, pixel, sample and use
// alone, whatever thread asks for it.
#ifndef VOXCAST_RENDERER_REFERENCE_SAMPLER_H
#define VOXCAST_RENDERER_REFERENCE_SAMPLER_H

#include <stdint.h>

// One sample of one pixel.
struct sampler {
    uint64_t key;            // of pixel and sequence
    uint32_t index_reversed; // bits of the sample's number in the sequence
};

// Sequences of different seed, pixel or `sequence` are independent of each other.
void sampler_init(struct sampler *sampler, uint64_t seed, uint32_t pixel, uint32_t sequence,
                  uint32_t index);

// Numbers in [0, 1). Each use of a sample has a number of its own.
float sampler_get_1d(const struct sampler *sampler, uint32_t use);
void sampler_get_2d(const struct sampler *sampler, uint32_t use, float out_u[2]);

#endif
