// Vectors of three floats in a SIMD register, the path tracer's inner loop. The fourth lane is
// alpha or undefined.
#ifndef VOXCAST_RENDERER_PATH_TRACER_VECTOR_H
#define VOXCAST_RENDERER_PATH_TRACER_VECTOR_H

#include <math.h>
#include <stdint.h>

typedef float float3 __attribute__((vector_size(16)));

static inline float3 make3(float x, float y, float z)
{
    return (float3){x, y, z, 0.0f};
}

static inline float3 splat3(float value)
{
    return (float3){value, value, value, value};
}

static inline float3 load3(const float values[3])
{
    return (float3){values[0], values[1], values[2], 0.0f};
}

static inline void store3(float out[3], float3 a)
{
    out[0] = a[0];
    out[1] = a[1];
    out[2] = a[2];
}

static inline float dot3(float3 a, float3 b)
{
    float3 product = a * b;
    return product[0] + product[1] + product[2];
}

static inline float3 cross3(float3 a, float3 b)
{
    return make3(a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]);
}

static inline float length3(float3 a)
{
    return sqrtf(dot3(a, a));
}

// Unit length; zero vectors stay unchanged.
static inline float3 normalize3(float3 a)
{
    float squared = dot3(a, a);
    return squared > 0.0f ? a * (1.0f / sqrtf(squared)) : a;
}

// If one is NaN, either may be returned. One instruction each, unlike fmaxf().
static inline float max1(float a, float b)
{
    return a > b ? a : b;
}

static inline float min1(float a, float b)
{
    return a < b ? a : b;
}

typedef int32_t mask3 __attribute__((vector_size(16)));

// Per lane.
static inline float3 smaller3(float3 a, float3 b)
{
    mask3 mask = a < b;
    return (float3)(((mask3)a & mask) | ((mask3)b & ~mask));
}

static inline float3 larger3(float3 a, float3 b)
{
    mask3 mask = a > b;
    return (float3)(((mask3)a & mask) | ((mask3)b & ~mask));
}

// The largest of the three.
static inline float max3(float3 a)
{
    return max1(a[0], max1(a[1], a[2]));
}

// Maximum extent of either along an axis.
static inline float span3(float3 a, float3 b)
{
    return max3(larger3(larger3(a, -a), larger3(b, -b)));
}

// Rec.709.
static inline float luminance3(float3 rgb)
{
    return 0.2126f * rgb[0] + 0.7152f * rgb[1] + 0.0722f * rgb[2];
}

static inline float clamp01(float a)
{
    return min1(max1(a, 0.0f), 1.0f);
}

static inline float3 clamp013(float3 a)
{
    return smaller3(larger3(a, (float3){0}), (float3){1.0f, 1.0f, 1.0f, 1.0f});
}

// Cosine and sine of a fraction of a full turn, 0 to 1, to 2e-7: Taylor series within an eighth of
// a turn of the nearest quarter, branch-free.
static inline void turn1(float fraction, float *out_cosine, float *out_sine)
{
    float quarter = fraction * 4.0f + 0.5f;
    int32_t number = (int32_t)quarter;
    float angle = (fraction - 0.25f * (float)number) * (2.0f * (float)M_PI), a2 = angle * angle;
    float sine =
        angle *
        (1.0f - a2 * (1.0f / 6.0f) *
                    (1.0f - a2 * (1.0f / 20.0f) *
                                (1.0f - a2 * (1.0f / 42.0f) * (1.0f - a2 * (1.0f / 72.0f)))));
    float cosine =
        1.0f - a2 * 0.5f *
                   (1.0f - a2 * (1.0f / 12.0f) *
                               (1.0f - a2 * (1.0f / 30.0f) * (1.0f - a2 * (1.0f / 56.0f))));
    float x = number & 1 ? sine : cosine, y = number & 1 ? cosine : sine;
    *out_cosine = (number + 1) & 2 ? -x : x;
    *out_sine = number & 2 ? -y : y;
}

// Two axes perpendicular to a unit normal and each other (Duff et al. 2017, "Building an
// Orthonormal Basis, Revisited").
static inline void basis3(float3 n, float3 *out_x, float3 *out_y)
{
    float sign = copysignf(1.0f, n[2]);
    float a = -1.0f / (sign + n[2]), b = n[0] * n[1] * a;
    *out_x = make3(1.0f + sign * n[0] * n[0] * a, sign * b, -sign * n[0]);
    *out_y = make3(b, sign + n[1] * n[1] * a, -n[1]);
}

#endif
