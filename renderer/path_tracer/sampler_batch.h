// The random numbers of sampler.h for many paths at once, in vector registers: bit-identical.
#ifndef VOXCAST_RENDERER_PATH_TRACER_SAMPLER_BATCH_H
#define VOXCAST_RENDERER_PATH_TRACER_SAMPLER_BATCH_H

#include "renderer/path_tracer/sampler.h"

#define SAMPLER_BATCH_SIZE 64u

// Per path: its sampler and use.
struct sampler_batch {
    uint64_t keys[SAMPLER_BATCH_SIZE]; // of sampler and use
    uint32_t indices_reversed[SAMPLER_BATCH_SIZE];
};

struct sampler_numbers {
    float u[2][SAMPLER_BATCH_SIZE];
};

static inline void sampler_batch_set(struct sampler_batch *batch, uint32_t number,
                                     const struct sampler *sampler, uint32_t use)
{
    batch->keys[number] = sampler_key_of(sampler, use);
    batch->indices_reversed[number] = sampler->index_reversed;
}

// sampler_get_2d() for the first `count` paths; writes some more, with arbitrary values.
void sampler_batch_get_2d(const struct sampler_batch *batch, uint32_t count,
                          struct sampler_numbers *out_numbers);

#endif
