// What half floats cannot hold is cut, and counted. `counters` must be declared, and be writable.
#include "shared/voxel_records.h"

const float LARGEST_HALF = 65504.0;

vec3 clamp_to_half(vec3 value)
{
    if (!all(lessThanEqual(value, vec3(LARGEST_HALF)))) // NaN, too
        atomicAdd(counters[COUNTER_CLAMPED], 1u);
    return min(value, vec3(LARGEST_HALF));
}
