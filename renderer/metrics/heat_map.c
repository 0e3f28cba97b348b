#include "renderer/metrics/heat_map.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#define PI              3.14159265358979f
#define TABLE_SIZE      256
#define LOWEST          0.0f // OKLab lightness of error 0
#define HIGHEST         0.97f
#define LARGEST_CHROMA  0.22f
#define FIRST_HUE_RAD   (290.0f * PI / 180.0f) // violet
#define LAST_HUE_RAD    (470.0f * PI / 180.0f) // yellow, through red
#define BISECTION_STEPS 16

// Linear sRGB of an OKLab colour; false outside the sRGB gamut.
static bool linear_from_oklab(float lightness, float a, float b, float out_rgb[3])
{
    float l = lightness + 0.3963377774f * a + 0.2158037573f * b;
    float m = lightness - 0.1055613458f * a - 0.0638541728f * b;
    float s = lightness - 0.0894841775f * a - 1.2914855480f * b;
    l = l * l * l;
    m = m * m * m;
    s = s * s * s;
    out_rgb[0] = 4.0767416621f * l - 3.3077115913f * m + 0.2309699292f * s;
    out_rgb[1] = -1.2684380046f * l + 2.6097574011f * m - 0.3413193965f * s;
    out_rgb[2] = -0.0041960863f * l - 0.7034186147f * m + 1.7076147010f * s;
    bool inside = true;
    for (int c = 0; c < 3; c++)
        inside = inside && out_rgb[c] >= 0.0f && out_rgb[c] <= 1.0f;
    return inside;
}

static uint8_t srgb_byte(float linear)
{
    linear = fminf(fmaxf(linear, 0.0f), 1.0f);
    float value =
        linear <= 0.0031308f ? 12.92f * linear : 1.055f * powf(linear, 1.0f / 2.4f) - 0.055f;
    return (uint8_t)(value * 255.0f + 0.5f);
}

void heat_map_color(float error, uint8_t out_rgb[3])
{
    error = isnan(error) ? 1.0f : fminf(fmaxf(error, 0.0f), 1.0f);
    float lightness = LOWEST + (HIGHEST - LOWEST) * error;
    float hue = FIRST_HUE_RAD + (LAST_HUE_RAD - FIRST_HUE_RAD) * error;
    float chroma = LARGEST_CHROMA * sinf(PI * error);
    float rgb[3], a = cosf(hue), b = sinf(hue);
    if (!linear_from_oklab(lightness, chroma * a, chroma * b, rgb)) {
        float inside = 0.0f, outside = chroma;
        for (int i = 0; i < BISECTION_STEPS; i++) {
            float middle = 0.5f * (inside + outside);
            if (linear_from_oklab(lightness, middle * a, middle * b, rgb))
                inside = middle;
            else
                outside = middle;
        }
        linear_from_oklab(lightness, inside * a, inside * b, rgb);
    }
    for (int c = 0; c < 3; c++)
        out_rgb[c] = srgb_byte(rgb[c]);
}

void heat_map_colors(const float *errors, size_t count, uint8_t *out_rgb)
{
    uint8_t table[TABLE_SIZE][3];
    for (int i = 0; i < TABLE_SIZE; i++)
        heat_map_color((float)i / (TABLE_SIZE - 1), table[i]);
    for (size_t i = 0; i < count; i++) {
        float error = isnan(errors[i]) ? 1.0f : fminf(fmaxf(errors[i], 0.0f), 1.0f);
        memcpy(out_rgb + 3 * i, table[(int)(error * (TABLE_SIZE - 1) + 0.5f)], 3);
    }
}
