#include "renderer/gi/cones.h"

#include <math.h>

#define GOLDEN_ANGLE 2.39996322973f

static const uint32_t counts[CONE_SET_COUNT] = {
    [CONE_SET_AUTO] = 9, [CONE_SET_5] = 5,   [CONE_SET_6] = 6,
    [CONE_SET_9] = 9,    [CONE_SET_16] = 16, [CONE_SET_32] = 32,
};

// Directions of equal solid angle on a spiral (Vogel 1979); each cone takes the half-angle that its
// share of the hemisphere has.
void cone_directions_init(struct cone_directions *directions, enum cone_set set)
{
    uint32_t count = counts[set];
    *directions = (struct cone_directions){.count = count};
    float sum = 0.0f;
    for (uint32_t i = 0; i < count; i++) {
        float *cone = directions->cones[i];
        float cosine = 1.0f - ((float)i + 0.5f) / (float)count;
        float sine = sqrtf(1.0f - cosine * cosine);
        float angle = GOLDEN_ANGLE * (float)i;
        cone[0] = sine * cosf(angle);
        cone[1] = sine * sinf(angle);
        cone[2] = cosine;
        cone[3] = cosine;
        sum += cosine;
    }
    for (uint32_t i = 0; i < count; i++)
        directions->cones[i][3] /= sum;
    float half_cosine = 1.0f - 1.0f / (float)count;
    directions->tangent = sqrtf(1.0f - half_cosine * half_cosine) / half_cosine;
}
