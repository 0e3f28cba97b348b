// FLIP: how different two pictures look to somebody who flips between them.
//
// LDR-FLIP compares displayed pictures (Andersson, Nilsson, Akenine-Moller, Oskarsson, Astrom and
// Fairchild 2020, "FLIP: A Difference Evaluator for Alternating Images", Proc. ACM Comput. Graph.
// Interact. Tech. 3, 2): both are filtered by the contrast sensitivity of the eye, their colours
// compared by HyAB distance in Hunt-adjusted L*a*b*, and differences at edges and points amplified.
// HDR-FLIP compares radiance (Andersson, Nilsson, Shirley and Akenine-Moller 2021, "Visualizing
// Errors in Rendered High Dynamic Range Images", Eurographics Short Papers): LDR-FLIP at a series
// of exposures, the largest error of each pixel.
#ifndef VOXCAST_RENDERER_METRICS_FLIP_H
#define VOXCAST_RENDERER_METRICS_FLIP_H

#include "renderer/metrics/picture.h"

// Of a 0.7 m wide monitor of 3840 pixels seen from 0.7 m, as the papers have it.
#define FLIP_PIXELS_PER_DEGREE 67.0206f

#define FLIP_MAX_EXPOSURES 32u

// Exposures that HDR-FLIP goes through, in stops: radiance is scaled by 2^stops.
struct flip_exposures {
    float start_stops;
    float stop_stops;
    uint32_t count; // evenly spaced, both ends included
};

// Compares two pictures of one size with display values 0..1 (sRGB). Writes width x height errors,
// 0 (same) to 1, into `out_map`. Cost: about 1 us a pixel. False when out of memory.
bool flip_ldr(const struct picture *test, const struct picture *reference, float pixels_per_degree,
              float *out_map);

// The exposures for a reference picture: from the one that shows its brightest pixel as 0.85 of
// white to the one that shows its median luminance so, about a
// stop apart; at most FLIP_MAX_EXPOSURES.
struct flip_exposures flip_find_exposures(const struct picture *reference);

// Compares two pictures of one size with linear radiance; what is not finite or negative counts as
// black. The map is as of flip_ldr(); the cost is its, times the count of exposures.
bool flip_hdr(const struct picture *test, const struct picture *reference,
              const struct flip_exposures *exposures, float pixels_per_degree, float *out_map);

#endif
