// Automatic exposure from a luminance histogram. In: radiance. Out: exposure scale. STAGE 0 counts
// log2 luminances; STAGE 1 (one group) takes their mean between two percentiles and maps it to
// middle grey. Integer counts do not depend on timing.
#include "lib/radiance_buffer.glsl"
#include "shared/display.h"

layout(std430, binding = BIND_EXPOSURE) buffer exposure_storage
{
    float automatic_exposure; // the scale
    float exposure_unused[3];
    uint histogram[HISTOGRAM_BINS];
};

const float LOWEST_STOP = -24.0;
const float BINS_PER_STOP = 2.6;

#if STAGE == EXPOSURE_HISTOGRAM
layout(local_size_x = PIXEL_GROUP_WIDTH, local_size_y = PIXEL_GROUP_HEIGHT) in;

shared uint bins[HISTOGRAM_BINS];

void main()
{
    uint own_bin = gl_LocalInvocationIndex; // of the first HISTOGRAM_BINS invocations
    if (own_bin < HISTOGRAM_BINS)
        bins[own_bin] = 0u;
    barrier();
    // Samples one of each 2 x 2 pixels: plenty for a mean.
    uvec2 pixel = gl_GlobalInvocationID.xy * 2u;
    if (all(lessThan(pixel, frame.render_size))) {
        float value = luminance(former_radiance(pixel.y * frame.render_size.x + pixel.x));
        if (value > 0.0 && !isinf(value)) {
            float bin = (log2(value) - LOWEST_STOP) * BINS_PER_STOP;
            atomicAdd(bins[uint(clamp(bin, 0.0, float(HISTOGRAM_BINS - 1)))], 1u);
        }
    }
    barrier();
    if (own_bin < HISTOGRAM_BINS && bins[own_bin] > 0u)
        atomicAdd(histogram[own_bin], bins[own_bin]);
}
#else
layout(local_size_x = 1) in;

const float MIDDLE_GREY = 0.3; // before the tone curve, which darkens it
const float LOW_PERCENTILE = 0.3;
const float HIGH_PERCENTILE = 0.95;

void main()
{
    float total = 0.0;
    for (uint i = 0u; i < HISTOGRAM_BINS; i++)
        total += float(histogram[i]);
    float skip = total * LOW_PERCENTILE;
    float left = total * (HIGH_PERCENTILE - LOW_PERCENTILE);
    float weight = 0.0;
    float sum = 0.0;
    for (uint i = 0u; i < HISTOGRAM_BINS; i++) {
        float count = float(histogram[i]);
        float skipped = min(count, skip);
        skip -= skipped;
        count = min(count - skipped, left);
        left -= count;
        weight += count;
        sum += count * ((float(i) + 0.5) / BINS_PER_STOP + LOWEST_STOP);
        histogram[i] = 0u;
    }
    automatic_exposure = weight > 0.0 ? MIDDLE_GREY * exp2(-sum / weight) : 1.0;
}
#endif
