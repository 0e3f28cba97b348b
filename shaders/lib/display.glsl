// Radiance to display values: exposure, tone curve (TONE_CURVE, as settings number them), transfer
// function (POWER_TRANSFER: a plain power, else sRGB).
#include "lib/frame.glsl"

#define TONEMAP_HABLE           0
#define TONEMAP_ACES            1
#define TONEMAP_KHRONOS_NEUTRAL 2

// Hable 2010, "Uncharted 2: HDR Lighting", with its white point of 11.2 and exposure bias of 2.
vec3 hable_curve(vec3 x)
{
    const float A = 0.15, B = 0.50, C = 0.10, D = 0.20, E = 0.02, F = 0.30;
    return (x * (A * x + C * B) + D * E) / (x * (A * x + B) + D * F) - E / F;
}

vec3 tonemap_hable(vec3 color)
{
    return hable_curve(2.0 * color) / hable_curve(vec3(11.2));
}

// Narkowicz 2015, "ACES Filmic Tone Mapping Curve".
vec3 tonemap_aces(vec3 color)
{
    color *= 0.6;
    return (color * (2.51 * color + 0.03)) / (color * (2.43 * color + 0.59) + 0.14);
}

// Khronos PBR Neutral tone mapper, specification of 2024.
vec3 tonemap_khronos_neutral(vec3 color)
{
    const float start = 0.8 - 0.04;
    const float desaturation = 0.15;
    float low = min(color.r, min(color.g, color.b));
    float offset = low < 0.08 ? low - 6.25 * low * low : 0.04;
    color -= offset;
    float peak = max(color.r, max(color.g, color.b));
    if (peak < start)
        return color;
    float d = 1.0 - start;
    float new_peak = 1.0 - d * d / (peak + d - start);
    color *= new_peak / peak;
    float g = 1.0 - 1.0 / (desaturation * (peak - new_peak) + 1.0);
    return mix(color, vec3(new_peak), g);
}

vec3 tonemap(vec3 color)
{
#if TONE_CURVE == TONEMAP_HABLE
    return tonemap_hable(color);
#elif TONE_CURVE == TONEMAP_ACES
    return tonemap_aces(color);
#elif TONE_CURVE == TONEMAP_KHRONOS_NEUTRAL
    return tonemap_khronos_neutral(color);
#else
    return color;
#endif
}

vec3 transfer(vec3 color)
{
    color = clamp(color, 0.0, 1.0);
#if POWER_TRANSFER
    return pow(color, vec3(1.0 / settings.gamma));
#else // IEC 61966-2-1
    return mix(1.055 * pow(color, vec3(1.0 / 2.4)) - 0.055, 12.92 * color,
               lessThanEqual(color, vec3(0.0031308)));
#endif
}
