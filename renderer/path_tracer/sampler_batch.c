#include "renderer/path_tracer/sampler_batch.h"

#include <stddef.h>

// Paths per vector loop; divides SAMPLER_BATCH_SIZE.
#define GROUP 16u

static inline __attribute__((always_inline)) void get_2d(const struct sampler_batch *restrict batch,
                                                         uint32_t count,
                                                         struct sampler_numbers *restrict numbers)
{
    for (size_t first = 0; first < count; first += GROUP) {
        const uint64_t *keys = batch->keys + first;
        const uint32_t *indices = batch->indices_reversed + first;
        float *u = numbers->u[0] + first, *v = numbers->u[1] + first;
        for (size_t i = 0; i < GROUP; i++)
            sampler_get_2d_of(sampler_mix(keys[i]), indices[i], &u[i], &v[i]);
    }
}

#ifdef __x86_64__
static __attribute__((target("avx512f,avx512dq"))) void
get_2d_avx512(const struct sampler_batch *batch, uint32_t count,
              struct sampler_numbers *out_numbers)
{
    get_2d(batch, count, out_numbers);
}

static __attribute__((target("avx2"))) void
get_2d_avx2(const struct sampler_batch *batch, uint32_t count, struct sampler_numbers *out_numbers)
{
    get_2d(batch, count, out_numbers);
}
#endif

void sampler_batch_get_2d(const struct sampler_batch *batch, uint32_t count,
                          struct sampler_numbers *out_numbers)
{
#ifdef __x86_64__
    if (__builtin_cpu_supports("avx512dq")) {
        get_2d_avx512(batch, count, out_numbers);
        return;
    }
    if (__builtin_cpu_supports("avx2")) {
        get_2d_avx2(batch, count, out_numbers);
        return;
    }
#endif
    get_2d(batch, count, out_numbers);
}
