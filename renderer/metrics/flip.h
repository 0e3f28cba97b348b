// FLIP: perceived difference between two images when flipping between them.
//
// LDR-FLIP compares displayed images (Andersson, Nilsson, Akenine-Moller, Oskarsson, Astrom and
// Fairchild 2020, "FLIP: A Difference Evaluator for Alternating Images", Proc. ACM Comput. Graph.
// Interact. Tech. 3, 2): filters both by the eye's contrast sensitivity, compares colours by HyAB
// distance in Hunt-adjusted L*a*b*, and amplifies differences at edges and points. HDR-FLIP
// compares radiance (Andersson, Nilsson, Shirley and Akenine-Moller 2021, "Visualizing Errors in
// Rendered High Dynamic Range Images", Eurographics Short Papers): the maximum of LDR-FLIP per
// pixel over a series of exposures.
#ifndef VOXCAST_RENDERER_METRICS_FLIP_H
#define VOXCAST_RENDERER_METRICS_FLIP_H

#include "renderer/metrics/picture.h"

// For a monitor of 0.7 m and 3840 pixels width seen from 0.7 m, as in the papers.
#define FLIP_PIXELS_PER_DEGREE 67.0206f

#define FLIP_MAX_EXPOSURES 32u

// Exposures of HDR-FLIP in stops: radiance is scaled by 2^stops.
struct flip_exposures {
    float start_stops;
    float stop_stops;
    uint32_t count; // evenly spaced, including both ends
};

// Compares two images of one size with display values 0..1 (sRGB). Writes width x height errors, 0
// (equal) to 1, to `out_map`. Cost: about 1 us per pixel. False when out of memory.
bool flip_ldr(const struct picture *test, const struct picture *reference, float pixels_per_degree,
              float *out_map);

// Exposures for a reference image: from the one that maps its brightest pixel to 0.85 of white to
// the one that maps its median luminance there, about a stop apart; at most FLIP_MAX_EXPOSURES.
struct flip_exposures flip_find_exposures(const struct picture *reference);

// Compares two images of one size with linear radiance; non-finite and negative values count as
// black. Map and errors as flip_ldr(); cost of flip_ldr() per exposure.
bool flip_hdr(const struct picture *test, const struct picture *reference,
              const struct flip_exposures *exposures, float pixels_per_degree, float *out_map);

#endif
