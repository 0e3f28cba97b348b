// Clamps to the range of half floats and counts what was clamped. `counters` must be declared
// writable.
#include "shared/voxel_records.h"

const float LARGEST_HALF = 65504.0;

vec3 clamp_to_half(vec3 value)
{
    if (!all(lessThanEqual(value, vec3(LARGEST_HALF)))) // also true for NaN
        atomicAdd(counters[COUNTER_CLAMPED], 1u);
    return min(value, vec3(LARGEST_HALF));
}
