#include "renderer/metrics/display.h"

#include <math.h>
#include <string.h>

#include "shared/display.h"

// As shaders/post/exposure.comp.
#define LOWEST_STOP     -24.0f
#define BINS_PER_STOP   2.6f
#define MIDDLE_GREY     0.3f
#define LOW_PERCENTILE  0.3f
#define HIGH_PERCENTILE 0.95f

static float luminance(const float rgb[3])
{
    return 0.2126f * rgb[0] + 0.7152f * rgb[1] + 0.0722f * rgb[2];
}

float display_automatic_exposure(const struct picture *picture)
{
    uint32_t histogram[HISTOGRAM_BINS] = {0};
    float total = 0.0f;
    for (uint32_t y = 0; y < picture->height; y += 2)
        for (uint32_t x = 0; x < picture->width; x += 2) {
            float value = luminance(picture->rgb + ((size_t)y * picture->width + x) * 3);
            if (!(value > 0.0f) || isinf(value))
                continue;
            float bin = (log2f(value) - LOWEST_STOP) * BINS_PER_STOP;
            histogram[(uint32_t)fminf(fmaxf(bin, 0.0f), HISTOGRAM_BINS - 1)]++;
            total += 1.0f;
        }
    float skip = total * LOW_PERCENTILE, left = total * (HIGH_PERCENTILE - LOW_PERCENTILE);
    float weight = 0.0f, sum = 0.0f;
    for (int i = 0; i < HISTOGRAM_BINS; i++) {
        float skipped = fminf((float)histogram[i], skip);
        skip -= skipped;
        float count = fminf((float)histogram[i] - skipped, left);
        left -= count;
        weight += count;
        sum += count * (((float)i + 0.5f) / BINS_PER_STOP + LOWEST_STOP);
    }
    return weight > 0.0f ? MIDDLE_GREY * exp2f(-sum / weight) : 1.0f;
}

// Hable 2010, "Uncharted 2: HDR Lighting", with its white point of 11.2 and exposure bias of 2.
static float hable_curve(float x)
{
    const float a = 0.15f, b = 0.50f, c = 0.10f, d = 0.20f, e = 0.02f, f = 0.30f;
    return (x * (a * x + c * b) + d * e) / (x * (a * x + b) + d * f) - e / f;
}

// Narkowicz 2015, "ACES Filmic Tone Mapping Curve".
static float aces_curve(float x)
{
    x *= 0.6f;
    return (x * (2.51f * x + 0.03f)) / (x * (2.43f * x + 0.59f) + 0.14f);
}

// Khronos PBR Neutral tone mapper, specification of 2024.
static void tonemap_khronos_neutral(float color[3])
{
    const float start = 0.8f - 0.04f, desaturation = 0.15f;
    float low = fminf(color[0], fminf(color[1], color[2]));
    float offset = low < 0.08f ? low - 6.25f * low * low : 0.04f;
    for (int c = 0; c < 3; c++)
        color[c] -= offset;
    float peak = fmaxf(color[0], fmaxf(color[1], color[2]));
    if (peak < start)
        return;
    float d = 1.0f - start;
    float new_peak = 1.0f - d * d / (peak + d - start);
    float g = 1.0f - 1.0f / (desaturation * (peak - new_peak) + 1.0f);
    for (int c = 0; c < 3; c++)
        color[c] = color[c] * new_peak / peak * (1.0f - g) + new_peak * g;
}

static float transfer(float value, float gamma)
{
    value = fminf(fmaxf(value, 0.0f), 1.0f);
    if (gamma > 0.0f)
        return powf(value, 1.0f / gamma);
    return value <= 0.0031308f ? 12.92f * value : 1.055f * powf(value, 1.0f / 2.4f) - 0.055f;
}

void display_pixel(const struct display_params *params, const float radiance[3],
                   float out_display[3])
{
    float color[3];
    for (int c = 0; c < 3; c++) {
        color[c] = fmaxf(radiance[c], 0.0f) * params->exposure;
        if (!isfinite(radiance[c]) || !isfinite(color[c])) {
            memset(out_display, 0, 3 * sizeof(float));
            return;
        }
    }
    // Far above white, squares would leave the range of floats.
    for (int c = 0; c < 3; c++)
        color[c] = fminf(color[c], 1e9f);
    if (params->tonemap == TONEMAP_KHRONOS_NEUTRAL)
        tonemap_khronos_neutral(color);
    for (int c = 0; c < 3; c++) {
        if (params->tonemap == TONEMAP_HABLE)
            color[c] = hable_curve(2.0f * color[c]) / hable_curve(11.2f);
        else if (params->tonemap == TONEMAP_ACES)
            color[c] = aces_curve(color[c]);
        out_display[c] = transfer(color[c], params->gamma);
    }
}

void display_picture(const struct display_params *params, const struct picture *radiance,
                     struct picture *out_picture)
{
    size_t count = picture_pixel_count(radiance);
    for (size_t i = 0; i < count; i++)
        display_pixel(params, radiance->rgb + 3 * i, out_picture->rgb + 3 * i);
}

void display_bytes(const struct display_params *params, const struct picture *radiance,
                   uint8_t *out_rgb)
{
    size_t count = picture_pixel_count(radiance);
    for (size_t i = 0; i < count; i++) {
        float display[3];
        display_pixel(params, radiance->rgb + 3 * i, display);
        for (size_t c = 0; c < 3; c++)
            out_rgb[3 * i + c] = (uint8_t)(255.0f * display[c] + 0.5f);
    }
}

float display_linear_from_srgb(float value)
{
    return value <= 0.04045f ? value / 12.92f : powf((value + 0.055f) / 1.055f, 2.4f);
}
