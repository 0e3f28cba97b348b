// Standard metrics of the difference between an image and its reference image.
//
// Images hold linear radiance. A pixel that is not finite in either image is excluded from radiance
// metrics and black in metrics of displayed images.
#ifndef VOXCAST_RENDERER_METRICS_IMAGE_METRICS_H
#define VOXCAST_RENDERER_METRICS_IMAGE_METRICS_H

#include "renderer/metrics/display.h"
#include "renderer/metrics/flip.h"
#include "renderer/metrics/picture.h"

enum image_metric {
    // Of linear radiance, over all pixels and channels; NaN if no pixel is finite.
    METRIC_RMSE,    // root of the mean squared error, cd/m^2
    METRIC_MAE,     // mean absolute error, cd/m^2
    METRIC_REL_MSE, // mean of squared error / (squared reference + 1 % of the mean square of the
                    // reference's channel); the latter term bounds the contribution of black pixels
    METRIC_P95,     // error (mean of the channels) that 95 % of the pixels do not exceed, cd/m^2
    METRIC_ENERGY_RED,   // mean over the reference's mean, per channel: above 1 is too bright
    METRIC_ENERGY_GREEN, // likewise
    METRIC_ENERGY_BLUE,  // likewise
    METRIC_HDR_FLIP,     // mean of the map, 0 to 1
    // Of displayed images.
    METRIC_PSNR, // 10 log10(1 / mean squared error), dB; infinite if nothing differs
    METRIC_SSIM, // of luma (Rec.601): Wang, Bovik, Sheikh and Simoncelli 2004, "Image Quality
                 // Assessment: From Error Visibility to Structural Similarity": Gaussian window of
                 // 11x11, sigma 1.5, K1 0.01, K2 0.03; 1 if nothing differs
    METRIC_LDR_FLIP, // mean of the map, 0 to 1
    // Of the tested image.
    METRIC_NOT_FINITE, // fraction of pixels, 0 to 1
    METRIC_COUNT
};

struct image_metric_info {
    const char *name;  // in JSON, e.g. "rel_mse"
    const char *title; // for display, e.g. "relMSE"
    const char *unit;  // "" for none
};

extern const struct image_metric_info image_metric_infos[METRIC_COUNT];

struct image_metrics {
    double values[METRIC_COUNT];
};

// Compares `test` with `reference` of the same size. `flip_map` is NULL or receives the width x
// height errors of LDR-FLIP. Cost: about a second for 640x360 pixels, mostly HDR-FLIP. False with a
// message that gives both sizes if these differ, or when memory runs out.
bool image_metrics_compute(const struct picture *test, const struct picture *reference,
                           const struct display_params *display, struct image_metrics *out_metrics,
                           float *flip_map, struct error *out_error);

// Error of a metric's value: 0 is perfect and larger is worse. 1 - SSIM, distance of an energy
// ratio from 1, 10^(-PSNR / 20); other metrics unchanged.
double image_metric_error(enum image_metric metric, double value);

// Subtracts `part` from `picture`, for example direct light to get indirect light. False with a
// message if the sizes differ.
bool picture_subtract(struct picture *picture, const struct picture *part, struct error *out_error);

#endif
