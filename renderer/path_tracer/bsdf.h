// How a surface scatters: the material model of shaders/lib/brdf.glsl (Lambert under a layer of
// GGX, as glTF 2.0, appendix B, defines it, or under Blinn-Phong), and refraction into bodies by
// the same microfacets (Walter et al. 2007, "Microfacet Models for Refraction through Rough
// Surfaces").
//
// Radiance inside bodies is divided by the square of their index of refraction: so it stays the
// same across a surface but for what is reflected or absorbed.
#ifndef VOXCAST_RENDERER_PATH_TRACER_BSDF_H
#define VOXCAST_RENDERER_PATH_TRACER_BSDF_H

#include "renderer/path_tracer/surface.h"

// A surface prepared for one direction of view.
struct bsdf {
    float3 normal, geometric_normal, view;
    float n_v;
    float alpha, lambda_v;
    float exponent; // of Blinn-Phong; 0 for GGX
    float3 diffuse; // reflectance of what lies below the layer
    float3 base_color, f0;
    float f90, metallic;
    float3 tint; // of what goes through, but for Fresnel; 0 without refraction
    float eta;   // index of refraction on the viewer's side over that beyond
    bool bends;  // eta matters to Fresnel, too
    // Probabilities of following each lobe.
    float p_diffuse, p_specular, p_transmit;
};

enum bsdf_lobes { BSDF_ALL, BSDF_TRANSMISSION };

// `eta` as above; 1 where nothing refracts. BSDF_TRANSMISSION leaves all reflection out.
void bsdf_init(struct bsdf *bsdf, const struct surface *surface, float eta, enum bsdf_lobes lobes);

// The same with lobes of at least this width.
void bsdf_widen(struct bsdf *bsdf, float alpha);

struct scattering {
    float3 fraction; // BSDF times cosine, per steradian
    float density;   // per steradian, of bsdf_sample() choosing this direction
};

// For light from `direction` (unit, away from the surface) towards the viewer. False, with all 0,
// if nothing comes that way.
bool bsdf_evaluate(const struct bsdf *bsdf, float3 direction, struct scattering *out_scattering);

// A random direction by three random numbers. False if the path ends here.
bool bsdf_sample(const struct bsdf *bsdf, float choice, const float u[2], float3 *out_direction,
                 struct scattering *out_scattering);

static inline float3 schlick(float3 f0, float3 f90, float cosine)
{
    float m = clamp01(1.0f - cosine), m2 = m * m;
    return f0 + (f90 - f0) * (m2 * m2 * m);
}

#endif
