// How far a picture is from the truth, by the measures that the field uses.
//
// Pictures hold linear radiance. A pixel that is not finite in either picture is left out of the
// measures of radiance, and black in those of displayed pictures.
#ifndef VOXCAST_RENDERER_METRICS_IMAGE_METRICS_H
#define VOXCAST_RENDERER_METRICS_IMAGE_METRICS_H

#include "renderer/metrics/display.h"
#include "renderer/metrics/flip.h"
#include "renderer/metrics/picture.h"

enum image_metric {
    // Of linear radiance, over all pixels and channels; NaN where no pixel is finite.
    METRIC_RMSE,         // root of the mean squared error, cd/m^2
    METRIC_MAE,          // mean absolute error, cd/m^2
    METRIC_REL_MSE,      // mean of squared error over squared truth + 1 % of the mean square of the
                         // truth's channel, which keeps black pixels from counting without bound
    METRIC_P95,          // error (mean of the channels) that 95 % of the pixels stay below, cd/m^2
    METRIC_ENERGY_RED,   // mean over the truth's mean, per channel: above 1 is too bright
    METRIC_ENERGY_GREEN, // likewise
    METRIC_ENERGY_BLUE,  // likewise
    METRIC_HDR_FLIP,     // mean of the map, 0 to 1
    // Of displayed pictures.
    METRIC_PSNR,     // 10 log10(1 / mean squared error), dB; infinite where nothing differs
    METRIC_SSIM,     // of luma (Rec.601): Wang, Bovik, Sheikh and Simoncelli 2004, "Image Quality
                     // Assessment: From Error Visibility to Structural Similarity": Gaussian window
                     // of 11x11, sigma 1.5, K1 0.01, K2 0.03; 1 where nothing differs
    METRIC_LDR_FLIP, // mean of the map, 0 to 1
    // Of the picture judged.
    METRIC_NOT_FINITE, // share of pixels, 0 to 1
    METRIC_COUNT
};

struct image_metric_info {
    const char *name;  // as JSON has it, such as "rel_mse"
    const char *title; // as people read it, such as "relMSE"
    const char *unit;  // "" for none
};

extern const struct image_metric_info image_metric_infos[METRIC_COUNT];

struct image_metrics {
    double values[METRIC_COUNT];
};

// Compares `test` with `reference` of the same size. `flip_map` is NULL or takes the width x height
// errors of LDR-FLIP. Cost: about a second for 640x360 pixels, most of it HDR-FLIP. False with a
// message that says both sizes if these differ, or when memory ends.
bool image_metrics_compute(const struct picture *test, const struct picture *reference,
                           const struct display_params *display, struct image_metrics *out_metrics,
                           float *flip_map, struct error *out_error);

// What a metric errs by, in a unit in which 0 is perfect and larger is worse: 1 - SSIM, distance of
// an energy ratio from 1, 10^(-PSNR / 20); other metrics as they are.
double image_metric_error(enum image_metric metric, double value);

// `picture` becomes what is left of it without `part`, such as indirect light without the direct.
// False with a message if the sizes differ.
bool picture_subtract(struct picture *picture, const struct picture *part, struct error *out_error);

#endif
