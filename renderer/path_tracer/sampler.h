// Low-discrepancy random numbers: for each use along a path (a pair of dimensions) the first two
// dimensions of Sobol's sequence, Owen shuffled and scrambled by hashing (Burley 2020, "Practical
// Hash-based Owen Scrambling"; the hash of Laine and Karras 2011 with Vegdahl's constants).
// Stateless: a number depends on seed, pixel, sample and use only, not on the thread.
#ifndef VOXCAST_RENDERER_PATH_TRACER_SAMPLER_H
#define VOXCAST_RENDERER_PATH_TRACER_SAMPLER_H

#include <stdint.h>

// One sample of one pixel.
struct sampler {
    uint64_t key;            // of pixel and sequence
    uint32_t index_reversed; // reversed bits of the sample's number in the sequence
};

// The finalizer of SplitMix64 (Steele, Lea and Flood 2014, "Fast Splittable Pseudorandom Number
// Generators").
static inline uint64_t sampler_mix(uint64_t z)
{
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

static inline uint32_t sampler_reverse_bits(uint32_t v)
{
    v = __builtin_bswap32(v);
    v = (v >> 4 & 0x0f0f0f0fu) | (v & 0x0f0f0f0fu) << 4;
    v = (v >> 2 & 0x33333333u) | (v & 0x33333333u) << 2;
    return (v >> 1 & 0x55555555u) | (v & 0x55555555u) << 1;
}

// A permutation in which each bit depends on lower bits only: Owen scrambling of bit-reversed
// numbers.
static inline uint32_t sampler_scramble_reversed(uint32_t v, uint32_t seed)
{
    v ^= v * 0x3d20adeau;
    v += seed;
    v *= (seed >> 16) | 1u;
    v ^= v * 0x05526c56u;
    return v ^ v * 0x53a22864u;
}

// Sobol's second dimension, bit-reversed. Bit k is the sum modulo 2 of the index's bits i for which
// the binomial coefficient (i over k) is odd, that is (Lucas) those whose i contains all bits of k:
// a sum over supersets.
static inline uint32_t sampler_sobol_second_reversed(uint32_t index)
{
    index ^= index >> 1 & 0x55555555u;
    index ^= index >> 2 & 0x33333333u;
    index ^= index >> 4 & 0x0f0f0f0fu;
    index ^= index >> 8 & 0x00ff00ffu;
    return index ^ (index >> 16 & 0x0000ffffu);
}

static inline float sampler_to_unit(uint32_t bits)
{
    return (float)(int32_t)(bits >> 8) * 0x1p-24f;
}

// Sequences of different seed, pixel or `sequence` are independent.
static inline void sampler_init(struct sampler *sampler, uint64_t seed, uint32_t pixel,
                                uint32_t sequence, uint32_t index)
{
    sampler->key =
        sampler_mix(sampler_mix(seed + 0x9e3779b97f4a7c15u) ^ ((uint64_t)sequence << 32 | pixel));
    sampler->index_reversed = sampler_reverse_bits(index);
}

static inline uint64_t sampler_key_of(const struct sampler *sampler, uint32_t use)
{
    return sampler->key + use * 0x9e3779b97f4a7c15u;
}

// A number in [0, 1), different for each use of a sample.
static inline float sampler_get_1d(const struct sampler *sampler, uint32_t use)
{
    uint64_t key = sampler_mix(sampler_key_of(sampler, use));
    uint32_t index =
        sampler_reverse_bits(sampler_scramble_reversed(sampler->index_reversed, (uint32_t)key));
    return sampler_to_unit(
        sampler_reverse_bits(sampler_scramble_reversed(index, (uint32_t)(key >> 32))));
}

// For a mixed key.
static inline void sampler_get_2d_of(uint64_t key, uint32_t index_reversed, float *out_u,
                                     float *out_v)
{
    uint32_t first = (uint32_t)(key >> 32), second = first * 0x9e3779b1u ^ (uint32_t)key;
    uint32_t index = sampler_reverse_bits(sampler_scramble_reversed(index_reversed, (uint32_t)key));
    *out_u = sampler_to_unit(sampler_reverse_bits(sampler_scramble_reversed(index, first)));
    *out_v = sampler_to_unit(sampler_reverse_bits(
        sampler_scramble_reversed(sampler_sobol_second_reversed(index), second)));
}

// Two numbers in [0, 1), stratified together.
static inline void sampler_get_2d(const struct sampler *sampler, uint32_t use, float out_u[2])
{
    sampler_get_2d_of(sampler_mix(sampler_key_of(sampler, use)), sampler->index_reversed, &out_u[0],
                      &out_u[1]);
}

#endif
