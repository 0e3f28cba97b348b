#include "renderer/gi/voxel/cones.h"

#include <math.h>

#define GOLDEN_ANGLE 2.39996322973f

static const uint32_t counts[CONE_SET_COUNT] = {
    [CONE_SET_AUTO] = 9, [CONE_SET_5] = 5,   [CONE_SET_6] = 6,
    [CONE_SET_9] = 9,    [CONE_SET_16] = 16, [CONE_SET_32] = 32,
};

uint32_t cone_set_count(enum cone_set set)
{
    return counts[set];
}

// Directions of equal solid angle on a spiral (Vogel 1979). The half-angle of each cone covers its
// fraction of the hemisphere.
void cone_directions_init(struct cone_directions *directions, enum cone_set set)
{
    uint32_t count = counts[set];
    *directions = (struct cone_directions){.count = count};
    float sum = 0.0f;
    for (uint32_t i = 0; i < count; i++) {
        struct voxel_cone *cone = &directions->cones[i];
        float cosine = 1.0f - ((float)i + 0.5f) / (float)count;
        float sine = sqrtf(1.0f - cosine * cosine);
        float angle = GOLDEN_ANGLE * (float)i;
        cone->direction[0] = sine * cosf(angle);
        cone->direction[1] = sine * sinf(angle);
        cone->direction[2] = cosine;
        cone->weight = cosine;
        sum += cosine;
    }
    for (uint32_t i = 0; i < count; i++)
        directions->cones[i].weight /= sum;
    float half_cosine = 1.0f - 1.0f / (float)count;
    directions->tangent = sqrtf(1.0f - half_cosine * half_cosine) / half_cosine;
}
