#include "renderer/reference/sampler.h"

// The finalizer of SplitMix64 (Steele, Lea and Flood 2014, "Fast Splittable Pseudorandom Number
// Generators").
static uint64_t mix(uint64_t z)
{
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

static uint32_t reverse_bits(uint32_t v)
{
    v = __builtin_bswap32(v);
    v = (v >> 4 & 0x0f0f0f0fu) | (v & 0x0f0f0f0fu) << 4;
    v = (v >> 2 & 0x33333333u) | (v & 0x33333333u) << 2;
    return (v >> 1 & 0x55555555u) | (v & 0x55555555u) << 1;
}

// Permutes numbers so that each bit depends on lower bits only: Owen's scrambling of the number
// whose bits these are in reverse.
static uint32_t scramble_reversed(uint32_t v, uint32_t seed)
{
    v ^= v * 0x3d20adeau;
    v += seed;
    v *= (seed >> 16) | 1u;
    v ^= v * 0x05526c56u;
    v ^= v * 0x53a22864u;
    return v;
}

// Sobol's second dimension, bits in reverse. Bit k of it is the sum modulo 2 of the index's bits i
// for which the binomial coefficient (i over k) is odd, that is (Lucas) those whose i has all bits
// of k: a sum over supersets.
static uint32_t sobol_second_reversed(uint32_t index)
{
    index ^= index >> 1 & 0x55555555u;
    index ^= index >> 2 & 0x33333333u;
    index ^= index >> 4 & 0x0f0f0f0fu;
    index ^= index >> 8 & 0x00ff00ffu;
    return index ^ (index >> 16 & 0x0000ffffu);
}

static float to_unit(uint32_t bits)
{
    return (float)(bits >> 8) * 0x1p-24f;
}

void sampler_init(struct sampler *sampler, uint64_t seed, uint32_t pixel, uint32_t sequence,
                  uint32_t index)
{
    sampler->key = mix(mix(seed + 0x9e3779b97f4a7c15u) ^ ((uint64_t)sequence << 32 | pixel));
    sampler->index_reversed = reverse_bits(index);
}

static uint64_t key_of_use(const struct sampler *sampler, uint32_t use)
{
    return mix(sampler->key + use * 0x9e3779b97f4a7c15u);
}

float sampler_get_1d(const struct sampler *sampler, uint32_t use)
{
    uint64_t key = key_of_use(sampler, use);
    // The first dimension is the index with its bits reversed, so shuffling alone would do; what
    // is scrambled besides is independent of the use's second dimension.
    uint32_t index = reverse_bits(scramble_reversed(sampler->index_reversed, (uint32_t)key));
    return to_unit(reverse_bits(scramble_reversed(index, (uint32_t)(key >> 32))));
}

void sampler_get_2d(const struct sampler *sampler, uint32_t use, float out_u[2])
{
    uint64_t key = key_of_use(sampler, use);
    uint32_t first = (uint32_t)(key >> 32), second = first * 0x9e3779b1u ^ (uint32_t)key;
    uint32_t index = reverse_bits(scramble_reversed(sampler->index_reversed, (uint32_t)key));
    out_u[0] = to_unit(reverse_bits(scramble_reversed(index, first)));
    out_u[1] = to_unit(reverse_bits(scramble_reversed(sobol_second_reversed(index), second)));
}
