// BSDF: the material model of shaders/lib/brdf.glsl (Lambert under a GGX layer, as glTF 2.0,
// appendix B, or under Blinn-Phong), and refraction into bodies by the same microfacets (Walter et
// al. 2007, "Microfacet Models for Refraction through Rough Surfaces").
//
// Radiance inside bodies is divided by their squared index of refraction: it is then constant
// across a surface except for reflection and absorption.
#ifndef VOXCAST_RENDERER_PATH_TRACER_BSDF_H
#define VOXCAST_RENDERER_PATH_TRACER_BSDF_H

#include "renderer/path_tracer/surface.h"

// A surface prepared for one view direction.
struct bsdf {
    float3 normal, geometric_normal, view;
    float n_v;
    float alpha, lambda_v;
    float exponent; // Blinn-Phong's; 0 for GGX
    float3 diffuse; // reflectance below the layer
    float3 base_color, f0;
    float f90, metallic;
    float3 tint; // of transmitted light, before Fresnel; 0 without refraction
    float eta;   // index of refraction on the viewer's side over that on the other
    bool bends;  // eta affects Fresnel, too
    // Probabilities of sampling each lobe.
    float p_diffuse, p_specular, p_transmit;
};

enum bsdf_lobes { BSDF_ALL, BSDF_TRANSMISSION };

// `eta` as above; 1 without refraction. BSDF_TRANSMISSION excludes reflection.
void bsdf_init(struct bsdf *bsdf, const struct surface *surface, float eta, enum bsdf_lobes lobes);

// Widens the lobes to at least `alpha`.
void bsdf_widen(struct bsdf *bsdf, float alpha);

struct scattering {
    float3 fraction; // BSDF times cosine, per steradian
    float density;   // of bsdf_sample() for this direction, per steradian
};

// For light from `direction` (unit, away from the surface) to the viewer. False, and all 0, if none
// arrives.
bool bsdf_evaluate(const struct bsdf *bsdf, float3 direction, struct scattering *out_scattering);

// Samples a direction with three random numbers. False if the path ends here.
bool bsdf_sample(const struct bsdf *bsdf, float choice, const float u[2], float3 *out_direction,
                 struct scattering *out_scattering);

static inline float3 schlick(float3 f0, float3 f90, float cosine)
{
    float m = clamp01(1.0f - cosine), m2 = m * m;
    return f0 + (f90 - f0) * (m2 * m2 * m);
}

#endif
