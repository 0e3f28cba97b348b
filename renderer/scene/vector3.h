// Three-component vectors in double, for geometry that must keep its direction at any scale.
#ifndef VOXCAST_RENDERER_SCENE_VECTOR3_H
#define VOXCAST_RENDERER_SCENE_VECTOR3_H

#include <math.h>

static inline void vector3_subtract(double out[3], const double a[3], const double b[3])
{
    for (int axis = 0; axis < 3; axis++) {
        out[axis] = a[axis] - b[axis];
    }
}

// `out` must be neither `a` nor `b`.
static inline void vector3_cross(double out[3], const double a[3], const double b[3])
{
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

static inline double vector3_dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline double vector3_length(const double a[3])
{
    return sqrt(vector3_dot(a, a));
}

#endif
